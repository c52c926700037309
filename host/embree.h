// Embree 3 (Debian 12) or 4 (Debian 13): the one place that tells them apart. The builder's interface is the same in both.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
