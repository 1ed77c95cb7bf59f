// Runs scenes of multibody systems in one go: file names on standard input, one line of JSON for each on
// standard output. Each runs in a process of its own, so that one that crashes or does not end costs no
// other.
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/error.hpp"
#include "common/log.hpp"
#include "common/scene/parse.hpp"
#include "mbd_server/coupling/mbd_solver.hpp"

namespace tandem {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

// Bodies and energy at the end of a window.
Json observed(const protocol::BodiesFrame& frame) {
  Json bodies = Json::array();
  for (const protocol::BodyState& b : frame.bodies) {
    const Quat& q = b.pose.q_WB;
    bodies.push_back(
        {numbers(b.pose.p_WB), {q.w, q.x, q.y, q.z}, numbers(b.twist.v_WB), numbers(b.twist.w_WB)});
  }
  return {{"time", to_seconds(frame.time)}, {"bodies", bodies}, {"energy", frame.energy}};
}

std::string text_of(const std::string& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

// The whole run of one scene: facts, frames after each window, and the error that ended it, if one did.
Json run(const std::string& file) {
  Json result{{"file", file}, {"status", "ok"}};
  try {
    const scene::Scene scene = scene::parse(text_of(file), file);
    mbd::MbdSolver solver;
    result["facts"] = Json::parse(solver.configure(scene).facts);
    result["start"] = observed(solver.observe());
    protocol::LoadSet loads;
    const Nanoseconds window = to_nanoseconds(scene.coupling.window), end = to_nanoseconds(scene.end_time);
    for (Nanoseconds begin{0}; begin < end; begin = loads.window.end) {
      loads.window = {loads.window.index, begin, begin + window};
      solver.advance(loads);
      ++loads.window.index;
      result["frames"].push_back(observed(solver.observe()));
    }
    result["report"] = Json::parse(solver.report().facts);
  } catch (const Error& error) {
    result["status"] = "refused";
    result["code"] = name(error.code());
    result["what"] = error.what();
  } catch (const std::exception& error) {
    result["status"] = "untyped error";
    result["what"] = error.what();
  }
  return result;
}

void run_apart(const std::string& file, unsigned seconds) {
  const pid_t child = fork();
  if (child == 0) {
    const itimerval limit{{}, {static_cast<time_t>(seconds), 0}};
    setitimer(ITIMER_PROF, &limit, nullptr);  // processor time, whatever else the machine does
    std::cout << run(file).dump() << std::endl;
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (!WIFSIGNALED(status)) return;
  const bool late = WTERMSIG(status) == SIGPROF;
  std::cout << Json{{"file", file},
                    {"status", late ? "too slow" : "died"},
                    {"what", late ? "still running after " + std::to_string(seconds) + " s of processor time"
                                  : "signal " + std::to_string(WTERMSIG(status))}}
                   .dump()
            << std::endl;
}

}  // namespace
}  // namespace tandem

int main(int argc, char** argv) {
  const unsigned seconds = argc > 1 ? static_cast<unsigned>(std::stoul(argv[1])) : 30;
  tandem::log::setup("run_machines", "error");
  for (std::string file; std::getline(std::cin, file);) tandem::run_apart(file, seconds);
}
