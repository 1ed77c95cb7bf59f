// Where two features touch, and how that changes with the displacements of their links.
#pragma once

#include "mbd_server/contact/touch_point.hpp"

namespace tandem::mbd {

// Distance of the shapes at that feature: negative where they overlap [m]. `rate` gets its rate [m/s].
double gap(const Model& model, const ContactFeature& feature, const std::vector<LinkMotion>& links,
           double* rate = nullptr);

// Place on the surface of b where the ball of a, or the line of a, is nearest to it; in the frame of link b
// [m].
Vector3d foot(const Model& model, const ContactFeature& feature, const std::vector<LinkMotion>& links);

Touch touch(const Model& model, const ContactFeature& feature, const std::vector<LinkMotion>& links,
            Derivatives derivatives = Derivatives::with);

}  // namespace tandem::mbd
