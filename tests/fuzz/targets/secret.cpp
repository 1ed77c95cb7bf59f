// Files that hold the secret of a run.
#include "protocol/secret.hpp"

#include <filesystem>

#include "tests/fuzz/files.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace tandem::fuzz {
namespace secret_part {

class SecretTarget : public Target {
 public:
  explicit SecretTarget(const std::filesystem::path& folder) : file_(folder / "secret") {
    put(file_, {});
    std::filesystem::permissions(file_,
                                 std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  }

  void run(std::span<const std::byte> input) override {
    put(file_, input);
    const std::string secret = protocol::take_secret(file_.string());
    constexpr const char* white = " \t\r\n";
    expect(secret.size() >= 32 && secret.size() <= 1024,
           "a secret that is too short or too long is accepted");
    expect(text_of(input).find(secret) != std::string::npos, "a secret is not what the file holds");
    expect(secret.find_first_of(white) != 0 && secret.find_last_of(white) != secret.size() - 1,
           "a secret has white space at an end");
  }

 private:
  std::filesystem::path file_;
};

std::vector<Bytes> secrets(const std::filesystem::path&) {
  return {bytes_of("0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef\n"),
          bytes_of(" 0123456789abcdef0123456789abcdef\r\n"), bytes_of(std::string(1024, 'x'))};
}

}  // namespace secret_part

TargetKind secret_target() {
  using namespace secret_part;
  return {.name = "secret", .corpus = secrets, .make = make_target<SecretTarget>};
}

}  // namespace tandem::fuzz
