#pragma once
/// Pictures and videos of a plan, made by the viewer's page in a headless browser.

#include "tandem/core/stop.h"
#include "tandem/server/server.h"

namespace tandem::server {

struct CaptureOptions {
  enum class Kind { kPng, kWebm } kind = Kind::kPng;
  double time = 0;                 ///< [s] of the motion that a PNG shows.
  int width = 1280, height = 720;  ///< [px]
  double fps = 25;                 ///< Pictures per second of a video.
};

/// @param page  the viewer's, see viewer_page.
/// @return the file's bytes; kNotFound without Chromium, kIo if it does not start, kTimeout or
/// kCancelled when `stop` says so, kUnsupported with the page's reason if it cannot make one.
Result<std::string> capture(std::shared_ptr<const world::Workcell> cell, PageData data,
                            std::string page, const CaptureOptions& options,
                            const StopCondition& stop);

}  // namespace tandem::server
