// lane_mask and lowest_lane as devices other than x86 compile them.
#undef __x86_64__
#include "node_test.cl"
