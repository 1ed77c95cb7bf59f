// Study files.
#include "launch/study/study_file.hpp"

#include "tests/fuzz/files.hpp"
#include "tests/fuzz/targets/shipped.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace tandem::fuzz {
namespace study_part {

class StudyTarget : public Target {
 public:
  explicit StudyTarget(const std::filesystem::path& folder) : file_(folder / "study.json") {
    put(folder / "pendulum.json", bytes_of(shipped_scene("pendulum")));
  }

  void run(std::span<const std::byte> input) override {
    put(file_, input);
    launch::read_study(file_);
  }

 private:
  std::filesystem::path file_;
};

constexpr const char* against_a_table = R"({
  "study": "1.0", "name": "pendulum", "description": "Against the closed form.", "scene": "pendulum.json",
  "sweep": [{"of": "rho_inf", "values": [0, 0.6, 1]}, {"of": "mbd_step", "values": [0.02, 0.01]}], "order_in": "mbd_step",
  "reference": {"type": "table", "source": "elliptic functions", "times": [1, 2],
                "signals": [{"of": "bob.position.x", "values": [0.98, -0.79]}, {"of": "bob.position.z", "values": [-0.1, -0.6]}]},
  "measures": [{"name": "position", "of": ["bob.position.x", "bob.position.z"], "unit": "m"},
               {"name": "energy", "of": ["summary.mbd_energy_drift_J"], "expected": 0, "unit": "J"}]
})";

std::vector<Bytes> studies(const std::filesystem::path&) {
  return {bytes_of(against_a_table)};
}

}  // namespace study_part

TargetKind study_target() {
  using namespace study_part;
  return {.name = "study", .text = true, .corpus = studies, .make = make_target<StudyTarget>};
}

}  // namespace tandem::fuzz
