// The folders in which a server may write and read states, given by its user at the start (--state-folder). A
// path from the coordinator is only a request: it must be inside one of them, no part of it may be a symbolic
// link, and a server without a folder refuses every path.
#pragma once

#include <string>
#include <vector>

#include "common/error.hpp"
#include "protocol/fd.hpp"

namespace tandem::protocol {

// A place in one of the folders that was reached without following a link. `path` keeps referring to that
// place, whatever happens to the names on the way.
class StatePlace {
 public:
  StatePlace(Fd held, std::string alias, std::string real, std::string rest)
      : held_(std::move(held)), alias_(std::move(alias)), real_(std::move(real)), rest_(std::move(rest)) {}
  // For opening: "/proc/self/fd/7/dem.h5".
  std::string path() const { return alias_ + rest_; }
  // The same error with the path that the coordinator gave.
  Error translated(const Error& error) const;

 private:
  Fd held_;
  std::string alias_, real_, rest_;
};

class StateFolders {
 public:
  // Throws Error{usage} where one is not a folder. Without folders every path is refused.
  explicit StateFolders(const std::vector<std::string>& folders);

  // A file that will be created or replaced in an existing folder. Throws Error{usage} outside our folders,
  // Error{resource} where a part of the path is a link or not a folder.
  StatePlace to_write(const std::string& path) const;
  // An existing regular file.
  StatePlace to_read(const std::string& path) const;

 private:
  struct Folder {
    std::string path;  // absolute, without "." and ".."
    Fd held;
  };
  struct Inside {
    Fd folder;         // parent of the file
    std::string name;  // of the file
  };
  Inside enter(const std::string& path, const char* deed) const;

  std::vector<Folder> folders_;
};

}  // namespace tandem::protocol
