#pragma once
/// Coordination diagrams as JSON and CSV, for plotting. The schema is docs/schemas.md.

#include <filesystem>
#include <string>

#include "tandem/coordination/drawing.h"

namespace tandem::io {

/// @param query  name of the query that the motions are of; may be empty.
std::string diagram_json(const coordination::DiagramDrawing& drawing, const world::Workcell& cell,
                         const std::string& query);
/// Rows of x0, y0, x1, y1, state, pair: the cells.
std::string diagram_cells_csv(const coordination::DiagramDrawing& drawing,
                              const world::Workcell& cell);
/// Rows of line, time, x, y: the lines' places.
std::string diagram_lines_csv(const coordination::DiagramDrawing& drawing);

/// Writes FILE as JSON, or if its name ends in .csv the cells to FILE and the lines to
/// STEM.lines.csv beside it.   @return kIo; kInvalidInput if one exists and `overwrite` is false.
Result<void> save_diagram(const std::filesystem::path& file,
                          const coordination::DiagramDrawing& drawing, const world::Workcell& cell,
                          const std::string& query, bool overwrite = false);

}  // namespace tandem::io
