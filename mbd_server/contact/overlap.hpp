// How deep a body and a mesh are inside each other, anywhere: contacts between them are found near their
// surfaces only.
#pragma once

#include <string>

#include "mbd_server/kinematics/kinematics.hpp"

namespace tandem::mbd {

struct Overlap {
  double depth = 0;    // of the deepest point [m]
  double thinner = 0;  // from the surface to the middle of the thinner shape there [m]
};

// Of the corners, ends, edges and the centre of a body in a closed mesh, and of the corners of a mesh in the
// body, where they are deeper than `share` of the thinner shape; else zero.
Overlap find_overlap(const Model& model, int body, int mesh, const std::vector<LinkMotion>& links,
                     double share);

// Sentences on the files of two shapes, after a "; " each, for a message that they overlap: a missing scale
// shows there.
std::string files_of(const ContactShape& a, const ContactShape& b);

}  // namespace tandem::mbd
