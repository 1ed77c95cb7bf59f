#include "protocol/violation.hpp"

namespace tandem::protocol {

std::string_view name(Violation violation) {
  switch (violation) {
    case Violation::truncated:
      return "truncated";
    case Violation::trailing_bytes:
      return "trailing_bytes";
    case Violation::count_too_large:
      return "count_too_large";
    case Violation::bad_magic:
      return "bad_magic";
    case Violation::bad_checksum:
      return "bad_checksum";
    case Violation::bad_header:
      return "bad_header";
    case Violation::wrong_version:
      return "wrong_version";
    case Violation::wrong_layout:
      return "wrong_layout";
    case Violation::wrong_role:
      return "wrong_role";
    case Violation::missing_capability:
      return "missing_capability";
    case Violation::refused:
      return "refused";
    case Violation::wrong_run:
      return "wrong_run";
    case Violation::wrong_generation:
      return "wrong_generation";
    case Violation::wrong_sequence:
      return "wrong_sequence";
    case Violation::not_allowed:
      return "not_allowed";
    case Violation::wrong_window:
      return "wrong_window";
    case Violation::wrong_iteration:
      return "wrong_iteration";
    case Violation::wrong_time:
      return "wrong_time";
    case Violation::not_finite:
      return "not_finite";
    case Violation::not_unit:
      return "not_unit";
    case Violation::not_positive:
      return "not_positive";
    case Violation::unknown_body:
      return "unknown_body";
    case Violation::missing_body:
      return "missing_body";
    case Violation::repeated_body:
      return "repeated_body";
    case Violation::bad_index:
      return "bad_index";
    case Violation::bad_fact:
      return "bad_fact";
  }
  return "unknown";
}

ProtocolError::ProtocolError(Violation violation, std::string problem, std::string where, std::string hint)
    : Error(violation == Violation::not_finite ? ErrorCode::numerics : ErrorCode::protocol,
            std::move(problem), std::move(where), std::move(hint)),
      violation_(violation) {}

}  // namespace tandem::protocol
