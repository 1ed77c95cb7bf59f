// One function for each target, in the file of its name. All other names of these files are in namespaces of
// their own, since sanitizer builds compile many files as one.
#pragma once

#include "tests/fuzz/target.hpp"

namespace tandem::fuzz {

TargetKind codec_target();      // frames of the protocol, one by one
TargetKind session_target();    // sequences of frames, to a server and to a coordinator
TargetKind shm_target();        // bytes of a peer in shared memory and on its socket
TargetKind scene_target();      // JSON of a scene
TargetKind overrides_target();  // options of `tandem run` that change a scene
TargetKind urdf_target();
TargetKind meshes_target();   // STL, OBJ
TargetKind csv_target();      // particle files, rows of a run
TargetKind restart_target();  // files of the multibody solver and of the coordinator
TargetKind particle_restart_target();
TargetKind frames_target();  // HDF5 files of a run, read back for its picture
TargetKind secret_target();
TargetKind recording_target();
TargetKind run_folder_target();  // markers and summaries of runs
TargetKind study_target();

// Sets the size and the checksum of a frame according to its bytes.
void reseal(Bytes& frame);

}  // namespace tandem::fuzz
