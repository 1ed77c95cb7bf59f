#include "common/geometry/triangle_mesh.hpp"
