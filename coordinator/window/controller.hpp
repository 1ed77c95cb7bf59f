// The source of a scene's control inputs: receives the sensor values at the begin of each window and returns
// the actuator values for it.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/scene/model.hpp"
#include "common/time.hpp"
#include "coordinator/start/processes.hpp"
#include "protocol/fd.hpp"

namespace tandem::launch {

class Controller {
 public:
  virtual ~Controller() = default;
  // `sensors` in the order of the scene's `sensors`; the result in the order of scene::control_inputs() [N
  // m] or [N].
  virtual const std::vector<double>& inputs(Nanoseconds now, const std::vector<double>& sensors) = 0;
};

// A program that reads and writes one JSON line per window; docs/control.md describes the lines.
class ControllerProgram final : public Controller {
 public:
  // Starts `command` by a shell. Its stderr is appended to `log`.
  ControllerProgram(const std::string& command, const scene::Scene& scene, std::chrono::milliseconds patience,
                    const std::filesystem::path& log);
  ~ControllerProgram() override;
  const std::vector<double>& inputs(Nanoseconds now, const std::vector<double>& sensors) override;

 private:
  void send(const std::string& line, Nanoseconds now);
  std::string receive(Nanoseconds now);
  void expect_silence(Nanoseconds now);
  void read(const std::string& line, Nanoseconds now);
  [[noreturn]] void fail(ErrorCode code, const std::string& problem, Nanoseconds now,
                         const std::string& hint = {});
  [[noreturn]] void fail_as_gone(Nanoseconds now);

  std::string command_;
  std::vector<std::string> sensor_names_, input_names_;
  std::chrono::milliseconds patience_;
  protocol::Fd ours_;
  std::string pending_;  // bytes after the last line
  std::vector<double> inputs_;
  protocol::Fd alive_;  // the shell that ends the program's process group reads the other end
  std::optional<Process> process_;
};

}  // namespace tandem::launch
