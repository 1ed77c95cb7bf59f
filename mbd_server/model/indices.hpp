#pragma once

namespace tandem::mbd {

using LinkIndex = int;
inline constexpr int none = -1;

}  // namespace tandem::mbd
