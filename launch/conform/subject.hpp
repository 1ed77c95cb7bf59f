// A participant under test. Each check starts it anew, so that no check depends on another one.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/start/server_command.hpp"
#include "protocol/channel.hpp"
#include "protocol/messages.hpp"

namespace tandem::conform {

// One start of the participant.
class Instance {
 public:
  virtual ~Instance() = default;
  // The coordinator's end; given away once.
  virtual std::unique_ptr<protocol::Channel> take_channel() = 0;
  // Waits at most `patience` for the end of the participant, and describes it: "exited with status 0". None
  // while it runs.
  virtual std::optional<std::string> ending(std::chrono::milliseconds patience) = 0;
};

class Subject {
 public:
  virtual ~Subject() = default;
  virtual protocol::Role role() const = 0;
  // `state_folder`: folder in which it may write and read states; empty: none.
  virtual std::unique_ptr<Instance> start(const std::filesystem::path& state_folder) = 0;
  // What the last instance has written to its standard error: the last line. Empty where that is not known.
  virtual std::string last_words() const { return {}; }
};

enum class Transport { shm, stream };

// A program that is started with the arguments of its channel after its own.
std::unique_ptr<Subject> make_subject(protocol::Role role, launch::ServerCommand program, Transport transport,
                                      const std::filesystem::path& log);

}  // namespace tandem::conform
