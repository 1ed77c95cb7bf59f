// Strong indices: a body index is not a joint index. Indices follow the order of the scene file.
#pragma once

#include <cstdint>
#include <functional>

namespace tandem {

template <class Tag>
struct Id {
  std::uint32_t value = 0;
  friend constexpr auto operator<=>(Id, Id) = default;
};

using BodyId = Id<struct BodyTag>;
using JointId = Id<struct JointTag>;
using MaterialId = Id<struct MaterialTag>;

// The inertial frame, which is not in the scene's list of bodies.
inline constexpr BodyId ground{0xffffffffu};

}  // namespace tandem
