// The groups of the self-test, a file each.
#pragma once

#include "inputs.h"
#include "launch.h"
#include "selftest.h"

namespace oclair::selftest {

using namespace test;  // the oracles, which the tests have too

// The device, and cl/selftest.cl compiled for it as the renderer's kernels are.
struct Session {
  const Device& device;
  cl::Program program;
};

// Division and square roots to half an ulp: build_program has asked for it.
inline bool rounds_correctly(const Device& device) {
  return (device.device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
}

// Runs `count` work items of a kernel of cl/selftest.cl, see launch(); fewer than PoCL compiles a kernel again for.
template <class... Arguments>
void run(const Session& session, const char* name, std::size_t count, const Arguments&... arguments) {
  launch(session.device, session.program, name, count, arguments...);
}

// By how much a bound grows that was derived for division and square roots rounded to half an ulp, where the device promises
// no more than OpenCL asks for: 2.5 and 3 ulp.
inline double slack(const Session& session) { return rounds_correctly(session.device) ? 1.0 : 6.0; }

inline constexpr std::size_t many = 64000;  // inputs of a launch

using Check = void(const Session&, Group&);

Check check_layout, check_contraction, check_accuracy, check_denormals, check_exceptions, check_integers, check_film,
    check_sampler, check_warps, check_mis, check_fresnel, check_textures, check_boxes, check_triangles, check_surfaces,
    check_render;

}  // namespace oclair::selftest
