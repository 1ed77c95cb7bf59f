// The one error type. Every message says what is wrong, where, and what to write instead.
#pragma once

#include <exception>
#include <string>
#include <string_view>

namespace tandem {

// The list of codes is part of the protocol: append only.
enum class ErrorCode : unsigned {
  internal = 1,     // a defect of tandem
  usage = 2,        // wrong command line
  scene = 3,        // wrong scene or mesh
  protocol = 4,     // a peer violated the protocol, or has another version
  peer_lost = 5,    // a peer died or went silent
  timeout = 6,      // a bounded wait ran out
  numerics = 7,     // a solver cannot continue: no convergence, NaN, overlap or speed limit
  resource = 8,     // memory, device, disk
  interrupted = 9,  // Ctrl-C or SIGTERM
};

std::string_view name(ErrorCode code);

// Exit status of every program of tandem (docs/conventions.md):
// 0 done, 1 done but a check failed, 2 wrong input, 3 numerics, 4 peer lost, protocol or time-out,
// 5 resource, 70 internal, 130 interrupted.
int exit_status(ErrorCode code);

class Error : public std::exception {
 public:
  // what: "mass is -1 kg"; where: "scene.json: mbd.bodies[2].mass"; hint: "give a mass > 0". where and hint
  // may be empty.
  Error(ErrorCode code, std::string what, std::string where = {}, std::string hint = {});

  ErrorCode code() const { return code_; }
  const std::string& problem() const { return problem_; }
  const std::string& where() const { return where_; }
  const std::string& hint() const { return hint_; }
  // "where: problem (hint)"
  const char* what() const noexcept override { return text_.c_str(); }

 private:
  ErrorCode code_;
  std::string problem_, where_, hint_, text_;
};

}  // namespace tandem
