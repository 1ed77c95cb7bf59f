// The file of a state from which a particle solver continues, read with the errors of what does not fit.
#pragma once

#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/state_file.hpp"
#include "protocol/messages.hpp"

namespace tandem::particles {

// The engine's arrays are in a group of their own.
inline std::string engine_array(const std::string& name) {
  return "engine/" + name;
}

class ResumedState {
 public:
  ResumedState(const protocol::Checkpoint& order, const char* kind, std::uint64_t version)
      : order_(order), file_(order.path, kind, version) {}

  const StateReader& file() const { return file_; }
  std::uint64_t number(const char* name) const;
  // Error{scene} where the state has `found` of something, and the scene `ours`.
  void expect_same(const char* what, const std::string& found, const std::string& ours,
                   const char* hint = "give the scene that the state was saved from") const;
  // Error{resource} where an array cannot be that of a state.
  void expect_sound(const char* name, bool sound, const char* problem) const;
  // Error{resource} where the state is not at the time of the order.
  void expect_time(Nanoseconds time) const;

  // Values with a function is_possible().
  template <class Value>
  void read(const char* name, std::span<Value> values) const {
    file_.read(name, std::as_writable_bytes(values));
    for (const Value& value : values) expect_sound(name, value.is_possible(), "a figure is not possible");
  }
  template <class Value>
  void read(const char* name, std::vector<Value>& values) const {
    if (!values.empty()) read(name, std::span(values));
  }

  // Calls read(a function that returns the bytes of an array of the engine by its name).
  template <class Read>
  void read_engine(Read read) const {
    try {
      read([this](const std::string& name) {
        std::vector<std::byte> bytes(file_.size(engine_array(name)));
        file_.read(engine_array(name), std::span(bytes));
        return bytes;
      });
    } catch (const Error& error) {
      throw error.where().empty() ? Error(error.code(), error.problem(), order_.path, error.hint()) : error;
    }
  }

 private:
  protocol::Checkpoint order_;
  StateReader file_;
};

}  // namespace tandem::particles
