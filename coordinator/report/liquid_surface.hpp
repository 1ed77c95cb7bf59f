// The particles of a liquid become a surface in pictures.
#pragma once

#include <filesystem>

#include "coordinator/report/frame.hpp"

namespace tandem::launch {

// The frame with the surface of its liquid; of the liquid's particles those stay that are outside of it, as
// drops. Runs liquid_surface.py, whose files are in `folder` until the end. After a warning the frame as it
// is: spheres.
Frame with_liquid_surface(Frame frame, const std::filesystem::path& folder);

}  // namespace tandem::launch
