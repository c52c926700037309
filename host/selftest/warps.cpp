#include "groups.h"

namespace oclair::selftest {
namespace {

// Every pair of 0, the smallest, the middle and the largest random number, and their neighbours; then random ones.
std::vector<cl_float2> squares() {
  const float edges[] = {0.0f, 0x1p-24f,        0x1p-23f, 0.25f,        0.5f - 0x1p-24f,
                         0.5f, 0.5f + 0x1p-24f, 0.75f,    1 - 0x1p-23f, 1 - 0x1p-24f};
  std::vector<cl_float2> list;
  for (const float x : edges)
    for (const float y : edges) list.push_back({{x, y}});
  Random random(8);
  while (list.size() < many) {
    const float x = random.unit24(), y = random.unit24();
    list.push_back({{x, y}});
  }
  return list;
}

double length(const cl_float4& v) { return std::hypot(v.s[0], v.s[1], v.s[2]); }

}  // namespace

// With r and its quarter turn exact, the sine 6.28 r (1 - ...) errs by u in its last product, u in the last fma, u/2 in its
// first coefficient and u/4 in the rest, of 0.71 at most: 1.9 u; the cosine, 1 - 19.7 r^2 (1 - ...), by 1.3 u; the
// polynomials by 3.2e-9: below 2 u + 4e-9. A direction adds the rounding of two roots and of two products: below 5 u. The
// cosine of the hemisphere is the root of an exact difference: half an ulp, and never 0.
void check_warps(const Session& session, Group& group) {
  const std::vector<cl_float2> u = squares();
  std::vector<cl_float2> circle(u.size()), triangle(u.size());
  std::vector<cl_float4> hemisphere(u.size()), sphere(u.size());
  run(session, "warps", u.size(), u, out(circle), out(hemisphere), out(sphere), out(triangle));
  double circle_error = 0, length_error = 0, cosine_error = 0;
  std::size_t in_surface = 0, outside = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const long double angle = 6.28318530717958647692528676655900577L * u[i].s[1], cosine = std::sqrt(1.0L - u[i].s[0]);
    keep_worst(circle_error, static_cast<double>(std::abs(circle[i].s[0] - std::cos(angle))));
    keep_worst(circle_error, static_cast<double>(std::abs(circle[i].s[1] - std::sin(angle))));
    keep_worst(length_error, std::abs(length(hemisphere[i]) - 1.0));
    keep_worst(length_error, std::abs(length(sphere[i]) - 1.0));
    keep_worst(cosine_error, static_cast<double>(std::abs(hemisphere[i].s[2] - cosine)) / ulp(static_cast<double>(cosine)));
    in_surface += !(hemisphere[i].s[2] > 0.0f);
    const double b1 = triangle[i].s[0], b2 = triangle[i].s[1];
    outside += !(b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0 + unit_roundoff);
  }
  group.bound("error of the circle", circle_error, 2 * unit_roundoff + 4e-9);
  group.bound("of lengths", length_error, 5 * unit_roundoff * slack(session));
  group.bound("ulp of the hemisphere's cosine", cosine_error, 0.5 * slack(session));
  group.bound("directions in the surface", static_cast<double>(in_surface), 0);
  group.bound("points outside the triangle", static_cast<double>(outside), 0);
}

}  // namespace oclair::selftest
