#include "tandem/core/result.h"

namespace tandem {

const char* to_string(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidInput:
      return "invalid_input";
    case ErrorCode::kNotFound:
      return "not_found";
    case ErrorCode::kIo:
      return "io";
    case ErrorCode::kUnsupported:
      return "unsupported";
    case ErrorCode::kInfeasible:
      return "infeasible";
    case ErrorCode::kNoPath:
      return "no_path";
    case ErrorCode::kCollision:
      return "collision";
    case ErrorCode::kLimits:
      return "limits";
    case ErrorCode::kCoordination:
      return "coordination";
    case ErrorCode::kTimeout:
      return "timeout";
    case ErrorCode::kCancelled:
      return "cancelled";
  }
  return "unknown";
}

}  // namespace tandem
