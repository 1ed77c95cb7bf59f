// Faults of received data. Each is an Error that ends the run on all sides.
#pragma once

#include <string>
#include <string_view>

#include "common/error.hpp"

namespace tandem::protocol {

enum class Violation {
  // frame
  truncated,
  trailing_bytes,
  count_too_large,
  bad_magic,
  bad_checksum,
  bad_header,
  // registration
  wrong_version,
  wrong_layout,
  wrong_role,
  missing_capability,
  refused,
  // session
  wrong_run,
  wrong_generation,
  wrong_sequence,
  not_allowed,
  wrong_window,
  wrong_iteration,
  wrong_time,
  // values
  not_finite,
  not_unit,
  not_positive,
  unknown_body,
  missing_body,
  repeated_body,
  bad_index,
  bad_fact,
};

std::string_view name(Violation violation);

class ProtocolError : public Error {
 public:
  // `where` names peer and message, `problem` the field and its value. A value that is not finite is a
  // numerical failure of a solver (Error{numerics}); every other violation is Error{protocol}.
  ProtocolError(Violation violation, std::string problem, std::string where = {}, std::string hint = {});
  Violation violation() const { return violation_; }

 private:
  Violation violation_;
};

}  // namespace tandem::protocol
