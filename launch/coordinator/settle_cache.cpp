#include "launch/coordinator/settle_cache.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <span>

#include "common/error.hpp"
#include "common/mix_word.hpp"
#include "common/state_file.hpp"
#include "common/utf8.hpp"

namespace tandem::launch {
namespace fs = std::filesystem;
namespace {

constexpr const char* kind = "settled bed";
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

// Of two digests with different starts, 128 bits.
template <class T>
std::string digest_text(const T& values) {
  const auto bytes = std::as_bytes(std::span(values));
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

std::uint64_t number_in(const StateReader& file, const std::string& name) {
  std::uint64_t number = 0;
  file.read(name, number);
  return number;
}
double value_in(const StateReader& file, const std::string& name) {
  double value = 0;
  file.read(name, value);
  return value;
}

std::string part(std::size_t group, const std::string& name) {
  return fmt::format("group_{}/{}", group, name);
}

void write(StateWriter& file, const CachedBed& bed) {
  file.write("time", bed.settled.time);
  file.write("kinetic_energy", bed.settled.kinetic_energy);
  file.write("groups", std::uint64_t{bed.settled.groups.size()});
  for (std::size_t g = 0; g < bed.settled.groups.size(); ++g) {
    const scene::ParticleFile& spheres = bed.settled.spheres[g];
    file.write(part(g, "name"), bed.settled.groups[g]);
    file.write(part(g, "position"), numbers(spheres.positions));
    file.write(part(g, "velocity"), numbers(spheres.velocities));
    file.write(part(g, "spin"), numbers(spheres.spins));
    file.write(part(g, "radius"), std::span(spheres.radii));
  }
  file.write("placed", std::uint64_t{bed.placed.size()});
  for (std::size_t g = 0; g < bed.placed.size(); ++g) {
    const PlacedGroup& placed = bed.placed[g];
    file.write(part(g, "placed"), placed.group);
    file.write(part(g, "from"), placed.from);
    file.write(part(g, "spheres"), placed.spheres);
    const double values[] = {placed.smallest, placed.largest, placed.mass, placed.void_fraction.value_or(-1)};
    file.write(part(g, "values"), std::span(values));
  }
}

CachedBed bed_in(const StateReader& file) {
  CachedBed bed;
  bed.settled.time = value_in(file, "time");
  bed.settled.kinetic_energy = value_in(file, "kinetic_energy");
  for (std::size_t g = 0, groups = number_in(file, "groups"); g < groups; ++g) {
    bed.settled.groups.push_back(file.text(part(g, "name")));
    scene::ParticleFile& spheres = bed.settled.spheres.emplace_back();
    spheres.positions = rows_in(file, part(g, "position"));
    spheres.velocities = rows_in(file, part(g, "velocity"));
    spheres.spins = rows_in(file, part(g, "spin"));
    spheres.radii.resize(file.size(part(g, "radius")));
    file.read(part(g, "radius"), std::span(spheres.radii));
    const std::size_t number = spheres.radii.size();
    if (number == 0 || spheres.positions.size() != number || spheres.velocities.size() != number ||
        spheres.spins.size() != number)
      throw Error(ErrorCode::resource, "is damaged: its lists differ in length", file.path().string());
  }
  for (std::size_t g = 0, groups = number_in(file, "placed"); g < groups; ++g) {
    PlacedGroup& placed = bed.placed.emplace_back();
    placed.group = file.text(part(g, "placed"));
    placed.from = file.text(part(g, "from"));
    placed.spheres = number_in(file, part(g, "spheres"));
    double values[4];
    file.read(part(g, "values"), std::span(values));
    placed.smallest = values[0], placed.largest = values[1], placed.mass = values[2];
    if (values[3] >= 0) placed.void_fraction = values[3];
  }
  return bed;
}

std::uint64_t size_of(const SettleKey& key, const CachedBed& bed) {
  std::uint64_t bytes = 65536 + key.text.size();
  for (const scene::ParticleFile& spheres : bed.settled.spheres) bytes += 80 * spheres.radii.size();
  return bytes;
}

// Why a bed of this user in the folder could be one that another user has put there; empty: it could not.
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

constexpr std::string_view bed_prefix = "settled_", bed_suffix = ".h5";

// Whether this is the name of a bed, and not that of a file of the user in a folder that is a cache as well.
bool is_bed(std::string_view name) {
  if (!name.starts_with(bed_prefix) || !name.ends_with(bed_suffix)) return false;
  name.remove_prefix(bed_prefix.size());
  name.remove_suffix(bed_suffix.size());
  return name.size() == 32 && name.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

// "draft_1234_settled_KEY.h5", or what it is written as before.
bool is_draft(std::string_view name) {
  if (!name.starts_with(draft_prefix)) return false;
  name.remove_prefix(std::string_view(draft_prefix).size());
  const std::size_t number = name.find_first_not_of("0123456789");
  if (number == 0 || number == std::string_view::npos || name[number] != '_') return false;
  name.remove_prefix(number + 1);
  return is_bed(name.substr(0, name.find(bed_suffix) + bed_suffix.size()));
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

std::string SettleKey::name() const {
  return fmt::format("{}{}{}", bed_prefix, digest_text(text), bed_suffix);
}

SettleKey key_of(const SceneFile& file, const scene::Settle& settle) {
  SettleKey key;
  key.text = fmt::format("program {:016x}\nkinetic_energy {} at_most {}\n", file_digest("/proc/self/exe"),
                         settle.kinetic_energy, settle.at_most);
  for (const protocol::NamedMesh& mesh : file.meshes)
    key.text += fmt::format("mesh {} {} {}\n", mesh.name, digest_text(mesh.mesh.vertices),
                            digest_text(mesh.mesh.triangles));
  for (const protocol::NamedText& text : file.files)
    key.text += fmt::format("file {} {}\n", text.name, digest_text(text.text));
  key.text += settling_scene(file.text);
  return key;
}

SettleCache::SettleCache() : folder_(usual_folder()), limit_(usual_limit * 1000000) {
  const std::string limit = variable("TANDEM_CACHE_MB");
  if (limit.empty()) return;
  std::uint64_t megabytes = 0;
  const auto [end, failure] = std::from_chars(limit.data(), limit.data() + limit.size(), megabytes);
  if (failure != std::errc() || end != limit.data() + limit.size() || megabytes > 1000000000)
    throw Error(ErrorCode::usage, "the value is '" + printable(shortened(limit)) + "'", "TANDEM_CACHE_MB",
                "give a whole number of megabytes");
  limit_ = megabytes * 1000000;
}

std::optional<CachedBed> SettleCache::find(const SettleKey& key, std::vector<std::string>& log) const {
  const fs::path path = path_of(key);
  std::error_code failure;
  if (folder_.empty() || !fs::exists(path, failure)) return {};
  const auto refuse = [&log](const fs::path& of, const std::string& danger, const char* remedy) {
    log.push_back(fmt::format("a settled bed in the cache is not used, and is made anew: {} {}: {}",
                              printable(of.string()), danger, remedy));
    return std::nullopt;
  };
  if (const std::string danger = danger_of(folder_); !danger.empty())
    return refuse(folder_, danger, "chmod go-w it, or name a folder of your own as TANDEM_CACHE");
  if (const std::string danger = danger_of_file(path); !danger.empty())
    return refuse(path, danger, "delete it");
  try {
    const StateReader file(path, kind, layout);
    if (file.text("key") != key.text) return {};
    CachedBed bed = bed_in(file);
    // The time of the last use.
    fs::last_write_time(path, fs::file_time_type::clock::now(), failure);
    return bed;
  } catch (const Error& error) {
    log.push_back("a settled bed in the cache is not used, and is made anew: " + error.where() + " " +
                  error.problem());
    fs::remove(path, failure);
    return {};
  }
}

void SettleCache::make_room(std::uint64_t bytes, std::vector<std::string>& log) const {
  struct Entry {
    fs::path path;
    fs::file_time_type used;
    std::uint64_t size;
  };
  std::vector<Entry> entries;
  std::uint64_t all = bytes;
  std::error_code failure;
  for (fs::directory_iterator at(folder_, failure), end; !failure && at != end; at.increment(failure)) {
    std::error_code gone;  // another run may remove it meanwhile
    const std::string name = at->path().filename().string();
    // Of runs that died while they wrote.
    if (is_draft(name) &&
        fs::last_write_time(at->path(), gone) < fs::file_time_type::clock::now() - draft_age && !gone)
      fs::remove(at->path(), gone);
    if (!is_bed(name)) continue;
    const Entry entry{at->path(), fs::last_write_time(at->path(), gone), fs::file_size(at->path(), gone)};
    if (gone) continue;
    entries.push_back(entry);
    all += entry.size;
  }
  std::ranges::sort(entries, {}, &Entry::used);
  for (auto entry = entries.begin(); entry != entries.end() && all > limit_; ++entry) {
    fs::remove(entry->path, failure);
    all -= entry->size;
    log.push_back("the cache is full: the bed that was not used for the longest time was removed, " +
                  printable(entry->path.string()));
  }
}

void SettleCache::keep(const SettleKey& key, const CachedBed& bed, std::vector<std::string>& log) const {
  if (folder_.empty()) return;
  const std::uint64_t bytes = size_of(key, bed);
  if (bytes > limit_) {
    log.push_back(
        fmt::format("the settled bed of {:.3g} MB is not kept: the cache has {:.3g} MB "
                    "(TANDEM_CACHE_MB enlarges it)",
                    static_cast<double>(bytes) / 1e6, static_cast<double>(limit_) / 1e6));
    return;
  }
  try {
    if (fs::create_directories(folder_)) fs::permissions(folder_, fs::perms::owner_all);
    if (const std::string danger = danger_of(folder_); !danger.empty())
      throw Error(ErrorCode::resource, danger, folder_.string(), "name a folder of your own as TANDEM_CACHE");
    make_room(bytes, log);
    // Two runs may write the same bed at once.
    const fs::path draft = folder_ / fmt::format("{}{}_{}", draft_prefix, getpid(), key.name());
    StateWriter file(draft, kind, layout);
    file.write("key", key.text);
    write(file, bed);
    file.commit();
    // Whatever the umask is: a bed that others can write is not used.
    fs::permissions(draft, fs::perms::owner_read | fs::perms::owner_write);
    fs::rename(draft, path_of(key));
    log.push_back("the settled bed is kept in " + printable(path_of(key).string()));
  } catch (const std::exception& error) {
    log.push_back("the settled bed is not kept, so that the next run takes as long: " +
                  std::string(error.what()));
  }
}

}  // namespace tandem::launch
