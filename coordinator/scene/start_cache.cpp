#include "coordinator/scene/start_cache.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>

#include "common/error.hpp"
#include "common/mix_word.hpp"
#include "common/utf8.hpp"

namespace tandem::launch {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t layout = 1;
constexpr std::uint64_t usual_limit = 2000;  // [MB]
constexpr const char* draft_prefix = "draft_";
constexpr auto draft_age = std::chrono::hours(24);

std::uint64_t digest_of(std::span<const std::byte> bytes, std::uint64_t start) {
  std::uint64_t digest = start;
  for (std::size_t at = 0; at < bytes.size(); at += sizeof digest) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, std::min(bytes.size() - at, sizeof word));
    digest = mix_word(digest, word);
  }
  return mix_word(digest, bytes.size());
}

// Why an entry of this user in the folder could be one that another user has put there; empty: it could not.
std::string danger_of(const fs::path& folder) {
  struct stat facts {};
  if (stat(folder.c_str(), &facts) != 0) return {};
  if (facts.st_uid != geteuid() && facts.st_uid != 0)
    return fmt::format("belongs to another user (uid {})", facts.st_uid);
  // In a folder with the sticky bit, such as /tmp, only their owner can replace files.
  if ((facts.st_mode & (S_IWGRP | S_IWOTH)) != 0 && (facts.st_mode & S_ISVTX) == 0)
    return "can be written by other users";
  return {};
}

// The same for one file.
std::string danger_of_file(const fs::path& file) {
  struct stat facts {};
  if (lstat(file.c_str(), &facts) != 0) return {};
  if (!S_ISREG(facts.st_mode)) return "is not a plain file";
  if (facts.st_uid != geteuid()) return fmt::format("belongs to another user (uid {})", facts.st_uid);
  if ((facts.st_mode & (S_IWGRP | S_IWOTH)) != 0) return "can be written by other users";
  return {};
}

constexpr std::string_view prefixes[]{"settled_", "filled_"}, suffix = ".h5";

// Whether this is the name of an entry, and not that of a file of the user in a folder that is a cache as
// well.
bool is_entry(std::string_view name) {
  const auto* prefix = std::ranges::find_if(prefixes, [&](auto p) { return name.starts_with(p); });
  if (prefix == std::end(prefixes) || !name.ends_with(suffix)) return false;
  name.remove_prefix(prefix->size());
  name.remove_suffix(suffix.size());
  return name.size() == 32 && name.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

// "draft_1234_settled_KEY.h5", or what it is written as before.
bool is_draft(std::string_view name) {
  if (!name.starts_with(draft_prefix)) return false;
  name.remove_prefix(std::string_view(draft_prefix).size());
  const std::size_t number = name.find_first_not_of("0123456789");
  if (number == 0 || number == std::string_view::npos || name[number] != '_') return false;
  name.remove_prefix(number + 1);
  return is_entry(name.substr(0, name.find(suffix) + suffix.size()));
}

std::string variable(const char* name) {
  const char* text = std::getenv(name);
  return text == nullptr ? "" : text;
}

fs::path usual_folder() {
  if (const std::string own = variable("TANDEM_CACHE"); !own.empty())
    return own == "off" ? fs::path() : fs::path(own);
  if (const std::string shared = variable("XDG_CACHE_HOME"); !shared.empty())
    return fs::path(shared) / "tandem";
  if (const std::string home = variable("HOME"); !home.empty()) return fs::path(home) / ".cache" / "tandem";
  return {};
}

}  // namespace

std::string digest_text(std::span<const std::byte> bytes) {
  return fmt::format("{:016x}{:016x}", digest_of(bytes, 0), digest_of(bytes, odd_1));
}

std::span<const double> numbers(const std::vector<Vec3d>& rows) {
  static_assert(sizeof(Vec3d) == 3 * sizeof(double));
  return {rows.empty() ? nullptr : &rows.front().x, 3 * rows.size()};
}

std::vector<Vec3d> rows_in(const StateReader& file, const std::string& name) {
  std::vector<Vec3d> rows(file.size(name) / 3);
  file.read(name, std::span<double>(rows.empty() ? nullptr : &rows.front().x, 3 * rows.size()));
  return rows;
}

std::string StartCache::Entry::name() const {
  return fmt::format("{}{}{}", prefix, digest_text(std::as_bytes(std::span(key))), suffix);
}

StartCache::StartCache() : folder_(usual_folder()), limit_(usual_limit * 1000000) {
  const std::string limit = variable("TANDEM_CACHE_MB");
  if (limit.empty()) return;
  std::uint64_t megabytes = 0;
  const auto [end, failure] = std::from_chars(limit.data(), limit.data() + limit.size(), megabytes);
  if (failure != std::errc() || end != limit.data() + limit.size() || megabytes > 1000000000)
    throw Error(ErrorCode::usage, "the value is '" + printable(shortened(limit)) + "'", "TANDEM_CACHE_MB",
                "give a whole number of megabytes");
  limit_ = megabytes * 1000000;
}

bool StartCache::find(const Entry& entry, const std::function<void(const StateReader&)>& read,
                      std::vector<std::string>& log) const {
  const fs::path path = path_of(entry);
  std::error_code failure;
  if (folder_.empty() || !fs::exists(path, failure)) return false;
  const std::string not_used = fmt::format("a {} in the cache is not used, and is made anew: ", entry.kind);
  const auto refuse = [&](const fs::path& of, const std::string& danger, const char* remedy) {
    log.push_back(fmt::format("{}{} {}: {}", not_used, printable(of.string()), danger, remedy));
    return false;
  };
  if (const std::string danger = danger_of(folder_); !danger.empty())
    return refuse(folder_, danger, "chmod go-w it, or name a folder of your own as TANDEM_CACHE");
  if (const std::string danger = danger_of_file(path); !danger.empty())
    return refuse(path, danger, "delete it");
  try {
    const StateReader file(path, entry.kind, layout);
    if (file.text("key") != entry.key) return false;
    read(file);
    // The time of the last use.
    fs::last_write_time(path, fs::file_time_type::clock::now(), failure);
    return true;
  } catch (const Error& error) {
    log.push_back(not_used + error.where() + " " + error.problem());
    fs::remove(path, failure);
    return false;
  }
}

void StartCache::make_room(std::uint64_t bytes, std::vector<std::string>& log) const {
  struct File {
    fs::path path;
    fs::file_time_type used;
    std::uint64_t size;
  };
  std::vector<File> files;
  std::uint64_t all = bytes;
  std::error_code failure;
  for (fs::directory_iterator at(folder_, failure), end; !failure && at != end; at.increment(failure)) {
    std::error_code gone;  // another run may remove it meanwhile
    const std::string name = at->path().filename().string();
    // Of runs that died while they wrote.
    if (is_draft(name) &&
        fs::last_write_time(at->path(), gone) < fs::file_time_type::clock::now() - draft_age && !gone)
      fs::remove(at->path(), gone);
    if (!is_entry(name)) continue;
    const File file{at->path(), fs::last_write_time(at->path(), gone), fs::file_size(at->path(), gone)};
    if (gone) continue;
    files.push_back(file);
    all += file.size;
  }
  std::ranges::sort(files, {}, &File::used);
  for (auto file = files.begin(); file != files.end() && all > limit_; ++file) {
    fs::remove(file->path, failure);
    all -= file->size;
    log.push_back("the cache is full: what was not used for the longest time was removed, " +
                  printable(file->path.string()));
  }
}

void StartCache::keep(const Entry& entry, std::uint64_t bytes, const std::function<void(StateWriter&)>& write,
                      std::vector<std::string>& log) const {
  if (folder_.empty()) return;
  if (bytes > limit_) {
    log.push_back(
        fmt::format("the {} of {:.3g} MB is not kept: the cache has {:.3g} MB (TANDEM_CACHE_MB enlarges it)",
                    entry.kind, static_cast<double>(bytes) / 1e6, static_cast<double>(limit_) / 1e6));
    return;
  }
  try {
    if (fs::create_directories(folder_)) fs::permissions(folder_, fs::perms::owner_all);
    if (const std::string danger = danger_of(folder_); !danger.empty())
      throw Error(ErrorCode::resource, danger, folder_.string(), "name a folder of your own as TANDEM_CACHE");
    make_room(bytes, log);
    // Two runs may write the same entry at once.
    const fs::path draft = folder_ / fmt::format("{}{}_{}", draft_prefix, getpid(), entry.name());
    StateWriter file(draft, entry.kind, layout);
    file.write("key", entry.key);
    write(file);
    file.commit();
    // Whatever the umask is: an entry that others can write is not used.
    fs::permissions(draft, fs::perms::owner_read | fs::perms::owner_write);
    fs::rename(draft, path_of(entry));
    log.push_back(fmt::format("the {} is kept in {}", entry.kind, printable(path_of(entry).string())));
  } catch (const std::exception& error) {
    log.push_back(
        fmt::format("the {} is not kept, so that the next run takes as long: {}", entry.kind, error.what()));
  }
}

}  // namespace tandem::launch
