// The folders in which a server may write and read states, given to it at its start (--state-folder) by its
// user. A path that the coordinator names is only a wish: it has to lie in one of them, no part of it may be
// a symbolic link, and a server without a folder writes and reads nothing.
#pragma once

#include <string>
#include <vector>

#include "common/error.hpp"
#include "protocol/fd.hpp"

namespace tandem::protocol {

// A place in one of the folders that was reached without following a link. `path` stays what was reached,
// whatever becomes of the names on the way.
class StatePlace {
 public:
  StatePlace(Fd held, std::string alias, std::string real, std::string rest)
      : held_(std::move(held)), alias_(std::move(alias)), real_(std::move(real)), rest_(std::move(rest)) {}
  // To open: "/proc/self/fd/7/dem.h5".
  std::string path() const { return alias_ + rest_; }
  // The same error with the path that the coordinator named.
  Error translated(const Error& error) const;

 private:
  Fd held_;
  std::string alias_, real_, rest_;
};

class StateFolders {
 public:
  // Error{usage} where one is no folder. No folders: everything is refused.
  explicit StateFolders(const std::vector<std::string>& folders);

  // A file that will be made, or replaced, in a folder that is there. Error{usage} outside of our folders,
  // Error{resource} where a part of the path is a link or no folder.
  StatePlace to_write(const std::string& path) const;
  // A file that is there, and is a file.
  StatePlace to_read(const std::string& path) const;

 private:
  struct Folder {
    std::string path;  // absolute, without "." and ".."
    Fd held;
  };
  struct Inside {
    Fd folder;         // that the file is in
    std::string name;  // of the file
  };
  Inside enter(const std::string& path, const char* deed) const;

  std::vector<Folder> folders_;
};

}  // namespace tandem::protocol
