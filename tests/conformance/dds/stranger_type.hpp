#pragma once
#include <dds/dds.h>

namespace tandem::protocol::test {
// Lives in a library of its own, because its C symbols have the names of the channel's.
const dds_topic_descriptor_t& stranger_type();
}  // namespace tandem::protocol::test
