// Data that decide whether two builds use the same bytes: the list of messages and the position of every
// field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "protocol/frame.hpp"

namespace tandem::protocol {

namespace layout {

// FNV-1a, 64 bit: simple and fast at compile time.
constexpr std::uint64_t start = 0xcbf29ce484222325;
constexpr std::uint64_t add(std::uint64_t hash, std::uint64_t value) {
  for (int i = 0; i < 8; ++i) hash = (hash ^ ((value >> (8 * i)) & 0xff)) * 0x100000001b3;
  return hash;
}
constexpr std::uint64_t add(std::uint64_t hash, std::string_view text) {
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return add(hash, text.size());
}

constexpr std::uint64_t of_messages() {
  std::uint64_t hash = add(start, sizeof(FrameHeader));
#define MESSAGE(name, code, sender, meaning) hash = add(add(add(hash, std::uint64_t{code}), #name), #sender);
#include "protocol/messages.def"
#undef MESSAGE
  return hash;
}

constexpr std::uint64_t of_records() {
  std::uint64_t hash = start;
#define RECORD(record, meaning) hash = add(add(hash, #record), sizeof(record));
#define FIELD(record, field, meaning) \
  hash = add(add(add(hash, #field), offsetof(record, field)), sizeof(record::field));
#define END(record)
#include "protocol/records.def"
#undef RECORD
#undef FIELD
#undef END
  return hash;
}

// Detects a field that is missing in records.def, and a gap, which would send uninitialised memory.
#define RECORD(record, meaning) static_assert(sizeof(record) == 0
#define FIELD(record, field, meaning) +sizeof(record::field)
#define END(record) , "records.def does not list every byte of " #record);
#include "protocol/records.def"
#undef RECORD
#undef FIELD
#undef END

}  // namespace layout

inline constexpr std::uint64_t layout_hash = layout::add(layout::of_messages(), layout::of_records());

}  // namespace tandem::protocol
