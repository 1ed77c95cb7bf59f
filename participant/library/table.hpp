// What both tables of functions have in common.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "participant/include/tandem/participant.h"
#include "participant/library/facts.hpp"
#include "participant/library/failure.hpp"
#include "protocol/messages.hpp"

namespace tandem::participant {

// A copy of the program's table. A program built with an older header has a shorter one; the functions that
// are missing are null, and their capabilities are not stated.
template <class Table>
Table copied(const Table& table) {
  constexpr std::size_t least = offsetof(Table, configure) + sizeof(void*);
  if (table.size < least || table.size > sizeof(Table))
    throw Error(ErrorCode::usage,
                "a table of " + std::to_string(table.size) + " bytes was given, this library knows " +
                    std::to_string(sizeof(Table)),
                "tandem participant",
                table.size > sizeof(Table)
                    ? "use the libtandem_participant that came with the header, or newer"
                    : "set size to sizeof of the table");
  Table copy{};
  std::memcpy(&copy, &table, table.size);
  return copy;
}

inline void expect_function(bool given, const char* function, const char* why) {
  if (!given)
    throw Error(ErrorCode::usage, std::string("has no function ") + function + ", which " + why,
                "tandem participant", "give one, or state less in `capabilities`");
}

// The functions that both roles have.
template <class Table>
void expect_common(const Table& table, std::uint64_t known) {
  if (const std::uint64_t other = table.capabilities & ~known; other != 0)
    throw Error(ErrorCode::usage,
                "states capabilities that its role does not have: bits " + std::to_string(other),
                "tandem participant", "see TANDEM_CAN_... in tandem/participant.h");
  constexpr const char* every = "every solver has";
  expect_function(table.configure, "configure", every);
  expect_function(table.advance, "advance", every);
  expect_function(table.observe, "observe", every);
  expect_function(table.report, "report", every);
  const bool rollback = table.capabilities & TANDEM_CAN_ROLLBACK;
  expect_function(!rollback || table.save, "save", "TANDEM_CAN_ROLLBACK promises");
  expect_function(!rollback || table.restore, "restore", "TANDEM_CAN_ROLLBACK promises");
  const bool files = table.capabilities & TANDEM_CAN_CHECKPOINT;
  expect_function(!files || table.checkpoint, "checkpoint", "TANDEM_CAN_CHECKPOINT promises");
  expect_function(!files || table.resume, "resume", "TANDEM_CAN_CHECKPOINT promises");
}

inline std::vector<std::string> names_of(const char* const* features) {
  std::vector<std::string> names;
  for (; features && *features; ++features) names.emplace_back(*features);
  return names;
}

// A record of zeros about this body.
template <class Record>
Record of_body(std::uint32_t body) {
  Record record;
  record.body = body;
  return record;
}
inline protocol::JointState of_joint(std::uint32_t joint) {
  protocol::JointState state;
  state.joint = joint;
  return state;
}

// `count` elements, for as many ids of 32 bit. A negative number of the program arrives as a huge one.
inline void expect_count(std::size_t count) {
  if (count > 0xffffffffu)
    throw Error(ErrorCode::internal, "is " + std::to_string(static_cast<std::int64_t>(count)),
                "observe: count", "set it to the number of particles in the arrays, 0 for none");
}

// Copies `from` into the vector `to` of the protocol.
template <class T>
void assign(std::vector<T>& to, const T* from, std::size_t count, const char* array) {
  if (count > 0 && !from)
    throw Error(ErrorCode::internal, "is null, with " + std::to_string(count) + " particles",
                std::string("observe: ") + array, "set the pointer to an array of the solver");
  to.assign(from, from + count);
}

}  // namespace tandem::participant
