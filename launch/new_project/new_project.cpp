#include "launch/new_project/new_project.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "common/error.hpp"
#include "common/utf8.hpp"
#include "coordinator/report/data_folder.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

// Names of targets that CMake and its generators have for themselves.
constexpr std::array taken{"all", "clean", "help", "install", "package", "test", "tandem", "build"};

void expect_name(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const bool fits =
      !name.empty() && name.size() <= 64 && letter(name[0]) && std::ranges::all_of(name, [&](char c) {
        return letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-';
      });
  if (!fits)
    throw Error(ErrorCode::usage, fmt::format("'{}' is no name for a program", shortened(name)), "NAME",
                "take a letter, and up to 63 letters, digits, _ and - after it");
  if (std::ranges::find(taken, name) != taken.end())
    throw Error(ErrorCode::usage, fmt::format("the build would confuse '{}' with something of its own", name),
                "NAME", "take another name");
}

std::set<std::string> languages(const fs::path& templates, const std::string& role) {
  std::set<std::string> found;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(templates, failed)) {
    const std::string folder = entry.path().filename().string();
    if (folder.ends_with("-" + role)) found.insert(folder.substr(0, folder.size() - role.size() - 1));
  }
  return found;
}

// Where each file of the project comes from.
std::map<fs::path, fs::path> sources(const fs::path& templates, const NewParticipant& wanted) {
  std::map<fs::path, fs::path> found;
  for (const std::string& folder : {wanted.role, wanted.language + "-" + wanted.role})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(templates / folder))
      if (entry.is_regular_file()) found[fs::relative(entry.path(), templates / folder)] = entry.path();
  return found;
}

void replace(std::string& text, const std::string& mark, const std::string& value) {
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + value.size()))
    text.replace(at, mark.size(), value);
}

std::string read(const fs::path& file) {
  std::stringstream text;
  if (!(text << std::ifstream(file, std::ios::binary).rdbuf()))
    throw Error(ErrorCode::resource, "cannot be read", file.string(), "install tandem again");
  return text.str();
}

// Of an installed tandem, the folder that CMAKE_PREFIX_PATH needs.
std::string prefix() {
  const fs::path folder = data_folder().parent_path().parent_path();
  return fs::exists(folder / "lib/cmake/tandem") ? folder.string() : "/path/of/installed/tandem";
}

}  // namespace

void new_participant(const NewParticipant& wanted) {
  expect_name(wanted.name);
  const fs::path templates = data_folder() / "templates";
  const std::set<std::string> known = languages(templates, wanted.role);
  if (known.empty())
    throw Error(ErrorCode::resource, "holds no templates", templates.string(), "install tandem again");
  if (!known.contains(wanted.language))
    throw Error(ErrorCode::usage, fmt::format("there is no template in '{}'", shortened(wanted.language)),
                "--language", fmt::format("there are: {}", fmt::join(known, ", ")));
  const fs::path folder = wanted.folder.empty() ? fs::path(wanted.name) : wanted.folder;
  std::error_code failed;
  if (folder.has_parent_path()) fs::create_directories(folder.parent_path(), failed);
  if (!failed && !fs::create_directory(folder, failed) && !failed)
    throw Error(ErrorCode::usage, "exists already, and is left as it is", folder.string(),
                "give another folder with --out, or remove that one");
  if (failed)
    throw Error(ErrorCode::resource, "cannot be made: " + failed.message(), folder.string(),
                "give a folder that you may write to with --out");
  for (const auto& [file, source] : sources(templates, wanted)) {
    std::string text = read(source);
    replace(text, "@NAME@", wanted.name);
    replace(text, "@PREFIX@", prefix());
    fs::create_directories((folder / file).parent_path());
    if (!(std::ofstream(folder / file, std::ios::binary) << text).flush())
      throw Error(ErrorCode::resource, "cannot be written", (folder / file).string(),
                  "free space on the disk");
  }
  fmt::print("{} is written; {} says how to build and run it\n", folder.string(),
             (folder / "README.md").string());
}

}  // namespace tandem::launch
