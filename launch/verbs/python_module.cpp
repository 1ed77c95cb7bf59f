#include "launch/verbs/python_module.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "common/error.hpp"
#include "coordinator/report/data_folder.hpp"

namespace tandem::launch {

void become_python(const std::string& module, const std::vector<std::string>& words) {
  constexpr const char* python = "/usr/bin/python3";
  std::string path = (data_folder() / "python").string();
  if (const char* given = std::getenv("PYTHONPATH")) path += fmt::format(":{}", given);
  setenv("PYTHONPATH", path.c_str(), 1);
  setenv("TANDEM", std::filesystem::read_symlink("/proc/self/exe").c_str(), 1);
  std::vector<std::string> all{python, "-m", module};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> argv;
  for (std::string& word : all) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(python, argv.data());
  throw Error(ErrorCode::resource, fmt::format("cannot be started: {}", strerror(errno)), python,
              "this verb needs the Debian packages python3, python3-numpy and python3-matplotlib");
}

}  // namespace tandem::launch
