#include "stranger_type.hpp"

#include "stranger.h"

__attribute__((visibility("default"))) const dds_topic_descriptor_t& tandem::protocol::test::stranger_type() {
  return tandem_dds_Chunk_desc;
}
