#include "tests/fuzz/targets/targets.hpp"

namespace tandem::fuzz {

std::span<const TargetKind> all_targets() {
  static const TargetKind targets[] = {
      codec_target(),  session_target(), shm_target(),       scene_target(),      overrides_target(),
      urdf_target(),   meshes_target(),  csv_target(),       restart_target(),    particle_restart_target(),
      frames_target(), secret_target(),  recording_target(), run_folder_target(), study_target()};
  return targets;
}

}  // namespace tandem::fuzz
