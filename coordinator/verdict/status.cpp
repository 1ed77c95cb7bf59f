#include "coordinator/verdict/status.hpp"

#include <unistd.h>

#include <fstream>
#include <iterator>
#include <sstream>

namespace tandem::launch {
namespace {

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

}  // namespace

const char* name(Status status) {
  switch (status) {
    case Status::running:
      return "running";
    case Status::ok:
      return "ok";
    case Status::suspect:
      return "suspect";
    case Status::failed:
      return "failed";
    case Status::died:
      return "died";
  }
  return "unknown";
}

std::uint64_t process_start(long pid) {
  // Field 22 of /proc/PID/stat (man 5 proc).
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t end_of_name = text.rfind(')');
  if (end_of_name == std::string::npos) return 0;
  std::istringstream fields(text.substr(end_of_name + 1));
  std::string state, field;
  fields >> state;
  if (state == "Z" || state == "X") return 0;
  for (int i = 4; i < 22; ++i) fields >> field;
  std::uint64_t start = 0;
  fields >> start;
  return start;
}

nlohmann::ordered_json this_process() {
  return {{"host", host_name()}, {"pid", getpid()}, {"started", process_start(getpid())}};
}

bool is_of_this_host(const nlohmann::json& summary) {
  const auto process = summary.find("process");
  return process != summary.end() && process->is_object() && process->value("host", "") == host_name();
}

std::string status_now(const nlohmann::json& summary) {
  const auto at = summary.find("status");
  if (at == summary.end() || !at->is_string()) return {};
  const std::string status = at->get<std::string>();
  if (status != name(Status::running) || !is_of_this_host(summary)) return status;
  const auto& process = summary["process"];
  const bool lives = process_start(process.value("pid", 0L)) == process.value("started", std::uint64_t{0});
  return lives ? status : name(Status::died);
}

}  // namespace tandem::launch
