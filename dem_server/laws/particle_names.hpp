// The names of what grains and liquid share, without a prefix.
#pragma once

namespace tandem::particles {}

namespace tandem::dem {
using namespace particles;
}  // namespace tandem::dem
