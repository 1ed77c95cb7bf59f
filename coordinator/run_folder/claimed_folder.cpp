#include "coordinator/run_folder/claimed_folder.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "common/error.hpp"
#include "common/file_draft.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

constexpr const char* remedy = "give a new or empty folder as --out";
constexpr std::size_t longest_mark = 4096;  // [bytes]

std::string name_of_mark(const Claim& claim) {
  return fmt::format("tandem_{}.json", claim.verb);
}
std::string format_of_mark(const Claim& claim) {
  return fmt::format("tandem {} folder", claim.verb);
}

void expect_inputs_kept(const fs::path& folder, const Claim& claim) {
  std::error_code failure;
  const fs::path target = fs::weakly_canonical(fs::absolute(folder), failure);
  for (const fs::path& input : claim.inputs) {
    if (input.empty()) continue;
    const fs::path absolute = fs::absolute(input);
    // As what it leads to, and by its own name, which may be a link.
    for (const fs::path& path :
         {fs::weakly_canonical(absolute, failure),
          fs::weakly_canonical(absolute.parent_path(), failure) / absolute.filename()}) {
      const fs::path inside = path.lexically_relative(target);
      if (inside.empty()) continue;
      const std::string name = inside.begin()->string();
      if (inside == name_of_mark(claim) || std::ranges::find(claim.names, name) != claim.names.end())
        throw Error(
            ErrorCode::usage,
            fmt::format("is an input of this tandem {}, and has the name of a result in the folder of --out: "
                        "it would be overwritten",
                        claim.verb),
            input.string(), "give another --out, or move the file");
    }
  }
}

// Whether this user has marked the folder. Another file of that name is refused, as it would be replaced.
bool is_marked(const fs::path& marker, const Claim& claim) {
  struct stat facts {};
  if (lstat(marker.c_str(), &facts) != 0) return false;
  std::string text(longest_mark, ' ');
  if (S_ISREG(facts.st_mode)) std::ifstream(marker).read(text.data(), longest_mark);
  const auto mark = nlohmann::json::parse(text, nullptr, false);
  if (!mark.is_object() || mark.value("/format"_json_pointer, nlohmann::json()) != format_of_mark(claim))
    throw Error(
        ErrorCode::usage,
        fmt::format("is there, and tandem {} has not written it: it would be overwritten", claim.verb),
        marker.string(), "give another --out, or move the file");
  if (facts.st_uid != geteuid())
    throw Error(ErrorCode::usage, fmt::format("the folder belongs to another user (uid {})", facts.st_uid),
                marker.string(), remedy);
  return true;
}

}  // namespace

void claim_folder(const fs::path& folder, const Claim& claim) {
  std::error_code failure;
  if (folder.empty()) throw Error(ErrorCode::usage, "is empty", "--out", "give the name of a folder");
  if (fs::exists(folder, failure) && !fs::is_directory(folder, failure))
    throw Error(ErrorCode::usage, "is not a folder", folder.string(), "give another --out");
  expect_inputs_kept(folder, claim);
  const fs::path marker = folder / name_of_mark(claim);
  if (!is_marked(marker, claim))
    for (const std::string& name : claim.names)
      if (fs::symlink_status(folder / name, failure).type() != fs::file_type::not_found)
        throw Error(ErrorCode::usage,
                    fmt::format("is there, and the folder has no {}: it is not of tandem {}, which would "
                                "overwrite it",
                                marker.filename().string(), claim.verb),
                    (folder / name).string(), remedy);
  fs::create_directories(folder, failure);
  if (failure)
    throw Error(ErrorCode::usage, "cannot be created: " + failure.message(), folder.string(),
                "give another --out");
  const nlohmann::ordered_json mark{{"format", format_of_mark(claim)}, {"version", 1}};
  replace_file(marker, mark.dump(2) + '\n');
}

}  // namespace tandem::launch
