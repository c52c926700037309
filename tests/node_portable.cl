// lane_mask as devices without x86 vectors compile it.
#undef __AVX__
#include "node_test.cl"
