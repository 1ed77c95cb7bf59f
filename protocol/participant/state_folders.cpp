#include "protocol/participant/state_folders.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>

namespace tandem::protocol {
namespace {

namespace fs = std::filesystem;

constexpr const char* option = "--state-folder";

std::string plain(const fs::path& path) {
  fs::path normal = fs::absolute(path).lexically_normal();
  if (!normal.has_filename()) normal = normal.parent_path();  // a slash at the end
  return normal.string();
}

std::string alias_of(const Fd& fd) {
  return "/proc/self/fd/" + std::to_string(fd.get());
}

// The part of `path` after `folder`/, if it is inside.
std::optional<fs::path> within(const std::string& folder, const fs::path& path) {
  const fs::path rest = path.lexically_relative(folder);
  if (rest.empty() || rest == "." || *rest.begin() == "..") return {};
  return rest;
}

[[noreturn]] void refuse_place(const fs::path& path, int problem) {
  const std::string what =
      problem == ELOOP || problem == ENOTDIR
          ? "is a symbolic link, or lies behind one or behind something that is no folder"
          : std::string("cannot be opened: ") + std::strerror(problem);
  throw Error(ErrorCode::resource, what, path.string(),
              "states are kept in plain files and folders; servers on other hosts need a disk that all hosts "
              "share");
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

}  // namespace

Error StatePlace::translated(const Error& error) const {
  const auto translate = [this](std::string text) {
    replace_all(text, alias_, real_);
    return text;
  };
  return {error.code(), translate(error.problem()), translate(error.where()), translate(error.hint())};
}

StateFolders::StateFolders(const std::vector<std::string>& folders) {
  for (const std::string& folder : folders) {
    // The user who starts this process may give a link on purpose; its present target is used from now
    // on.
    Fd held(open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (!held)
      throw Error(ErrorCode::usage, "\"" + folder + "\" is no folder: " + std::strerror(errno), option,
                  "make it, or give another");
    folders_.push_back({plain(folder), std::move(held)});
  }
}

StateFolders::Inside StateFolders::enter(const std::string& given, const char* deed) const {
  if (folders_.empty())
    throw Error(ErrorCode::usage,
                std::string("the coordinator wants this server to ") + deed + " " + given +
                    ", and it was given no folder for states",
                option, "start the server with --state-folder and the folder of that file");
  const fs::path path = plain(given);
  for (const Folder& folder : folders_) {
    const auto rest = within(folder.path, path);
    if (!rest) continue;
    Fd at(openat(folder.held.get(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    fs::path so_far = folder.path;
    for (const fs::path& part : rest->parent_path()) {
      if (!at) break;
      so_far /= part;
      at = Fd(openat(at.get(), part.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    }
    if (!at) refuse_place(so_far, errno);
    return {std::move(at), rest->filename().string()};
  }
  std::string list;
  for (const Folder& folder : folders_) list += (list.empty() ? "" : ", ") + folder.path;
  throw Error(ErrorCode::usage,
              std::string("the coordinator wants this server to ") + deed + " " + given +
                  ", outside of the folders for states: " + list,
              option, "start the server with the folder of that file, written as the coordinator writes it");
}

StatePlace StateFolders::to_write(const std::string& path) const {
  Inside inside = enter(path, "write");
  const std::string alias = alias_of(inside.folder);
  return {std::move(inside.folder), alias, fs::path(path).parent_path().string(), "/" + inside.name};
}

StatePlace StateFolders::to_read(const std::string& path) const {
  const Inside inside = enter(path, "read");
  // Non-blocking, in case it is a pipe.
  Fd file(openat(inside.folder.get(), inside.name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (!file && errno == ENOENT)
    throw Error(ErrorCode::resource, "does not exist", path,
                "servers on other hosts need a disk that all hosts share");
  if (!file) refuse_place(path, errno);
  struct stat status {};
  if (fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode))
    throw Error(ErrorCode::resource, "is no plain file", path);
  const std::string alias = alias_of(file);
  return {std::move(file), alias, path, ""};
}

}  // namespace tandem::protocol
