// Rays per second of our traversal against Embree's, on the same triangles and rays, in one thread.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "../bvh.h"
#include "bench.h"
#include "embree_peer.h"
#include "machine.h"
#include "our_traversal.h"
#include "subjects.h"

namespace oclair::bench {
namespace {

struct Peers {
  EmbreePeer plain, robust;
  explicit Peers(const Scene& scene) : plain(scene, false, "threads=1"), robust(scene, true, "threads=1") {
    plain.commit();
    robust.commit();
  }
};

std::vector<Hit> traced(const std::vector<Ray>& rays, RTCScene scene) {
  SingleRays singles(rays);
  singles.reset();
  singles.closest(scene);
  std::vector<Hit> hits(rays.size());
  for (std::size_t i = 0; i < hits.size(); ++i) hits[i] = singles.hit(i);
  return hits;
}

// Of hits that name another triangle, those at another distance are wrong; the others lie on an edge that both triangles
// have.
void report_agreement(const std::string& name, const RaySet& set, OurTraversal& ours, SingleRays& singles, RTCScene robust,
                      Table& table) {
  std::size_t missed = 0, other_triangle = 0, other_distance = 0;
  singles.reset();
  ours.run(set.any_hit);
  if (set.any_hit) {
    const std::vector<cl_uint> blocked = ours.blocked();
    singles.any(robust);
    std::size_t differ = 0;
    for (std::size_t i = 0; i < set.rays.size(); ++i) differ += (blocked[i] != 0) != singles.blocked(i);
    table.note("  " + name + ": " + std::to_string(differ) + " of " + std::to_string(set.rays.size()) +
               " rays are answered otherwise than by Embree robust");
    return;
  }
  const std::vector<Hit> hits = ours.hits();
  singles.closest(robust);
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    const Hit theirs = singles.hit(i);
    missed += hits[i].primitive == NONE;
    if (hits[i].primitive == theirs.primitive) continue;
    ++other_triangle;
    other_distance += !(std::abs(hits[i].t - theirs.t) <= 1e-5f);
  }
  table.note("  " + name + ": " + std::to_string(missed) + " of " + std::to_string(set.rays.size()) + " rays miss; " +
             std::to_string(other_triangle) + " hit another triangle than with Embree robust, " +
             std::to_string(other_distance) + " of them at another distance");
}

void compare(const Device& device, const std::string& subject, const RaySet& set, OurTraversal& ours, Peers& peers,
             unsigned rounds, Table& table) {
  ours.load(set.rays);
  SingleRays singles(set.rays);
  PacketRays packets(set.rays, set.coherent);
  const bool any = set.any_hit;
  const auto single = [&](RTCScene scene) {
    return Contender{[&] { singles.reset(); }, timed_on_cpu([&, scene] {
                       const FlushDenormals flush;
                       any ? singles.any(scene) : singles.closest(scene);
                     })};
  };
  const auto packet = [&](RTCScene scene) {
    return Contender{[&] { packets.reset(); }, timed_on_cpu([&, scene] {
                       const FlushDenormals flush;
                       any ? packets.any(scene) : packets.closest(scene);
                     })};
  };
  const Contender ours_timed{{}, timed_on(device, [&] { ours.run(any); })};
  const std::vector<Seconds> seconds =
      measure({ours_timed, single(peers.plain.scene()), single(peers.robust.scene()), packet(peers.plain.scene())}, rounds);
  const std::string query = any ? "rtcOccluded" : "rtcIntersect";
  const std::string name = subject + " " + set.name + (any ? " any" : " closest");
  const std::string names[] = {query + "1", query + "1 robust", query + "8" + (set.coherent ? " coherent" : "")};
  const auto rate = [&](const Seconds& s) { return static_cast<double>(set.rays.size()) * 1e-6 / spread_of(s).median; };
  for (std::size_t peer = 0; peer < std::size(names); ++peer)
    table.add({name + ": " + names[peer], "Mrays/s", rate(seconds[0]), rate(seconds[peer + 1]),
               ratio_of(seconds[peer + 1], seconds[0])});
  report_agreement(name, set, ours, singles, peers.robust.scene(), table);
}

// The line a + b log2(n) through the points, by least squares.
struct LogarithmFit {
  double a, b, worst;  // worst: largest deviation of the line from a point, relative to the point
};

LogarithmFit fit_of(const std::vector<std::pair<double, double>>& points) {
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (const auto& [n, y] : points) {
    const double x = std::log2(n);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double m = static_cast<double>(points.size());
  const double b = (m * sxy - sx * sy) / (m * sxx - sx * sx), a = (sy - b * sx) / m;
  double worst = 0.0;
  for (const auto& [n, y] : points) worst = std::max(worst, std::abs((a + b * std::log2(n)) / y - 1.0));
  return {a, b, worst};
}

std::string fit_text(const char* who, const LogarithmFit& fit) {
  char text[128];
  std::snprintf(text, sizeof text, "  %s: %.0f + %.0f log2(n) ns, at most %.0f %% off a point", who, fit.a, fit.b,
                100.0 * fit.worst);
  return text;
}

}  // namespace

void bench_traversal(const Options& options, Table& table) {
  use_one_core();
  const Device device = open_device(options.device);
  for (const Subject& subject : traversal_subjects(options, table)) {
    const Scene scene = subject.make();
    const Bvh bvh = build_bvh(scene, device.bvh_width);
    OurTraversal ours(device, scene, bvh);
    Peers peers(scene);
    table.heading("traversal, " + subject.name + ": " + std::to_string(scene.triangles.size()) +
                  " triangles, BVH of width " + std::to_string(bvh.width) + " and depth " + std::to_string(bvh.depth) +
                  ", one thread, load " + load_average());
    for (const RaySet& set :
         ray_sets(scene, [&](const std::vector<Ray>& rays) { return traced(rays, peers.robust.scene()); }))
      if (!set.rays.empty()) compare(device, subject.name, set, ours, peers, options.rounds, table);
  }
}

// Nanoseconds of a diffuse ray over the number of triangles.
void bench_growth(const Options& options, Table& table) {
  use_one_core();
  const Device device = open_device(options.device);
  table.heading("cost of a diffuse ray over the number of triangles, one thread, load " + load_average());
  std::vector<std::pair<double, double>> ours_points, peer_points;
  for (const std::size_t count : {10'000u, 30'000u, 100'000u, 300'000u, 1'000'000u, 3'000'000u, 10'000'000u}) {
    Options sized = options;
    sized.triangles = count;
    const Scene scene = traversal_subjects(sized, table).front().make();
    const Bvh bvh = build_bvh(scene, device.bvh_width);
    OurTraversal ours(device, scene, bvh);
    EmbreePeer peer(scene, false, "threads=1");
    peer.commit();
    const RaySet diffuse = ray_sets(scene, [&](const std::vector<Ray>& rays) { return traced(rays, peer.scene()); })[1];
    ours.load(diffuse.rays);
    SingleRays singles(diffuse.rays);
    const std::vector<Seconds> seconds =
        measure({{{}, timed_on(device, [&] { ours.run(false); })}, {[&] { singles.reset(); }, timed_on_cpu([&] {
                                                                      const FlushDenormals flush;
                                                                      singles.closest(peer.scene());
                                                                    })}},
                options.rounds);
    const auto nanoseconds = [&](const Seconds& s) {
      return spread_of(s).median * 1e9 / static_cast<double>(diffuse.rays.size());
    };
    ours_points.emplace_back(static_cast<double>(count), nanoseconds(seconds[0]));
    peer_points.emplace_back(static_cast<double>(count), nanoseconds(seconds[1]));
    table.add({"growth " + short_count(count) + ": rtcIntersect1", "ns/ray", ours_points.back().second,
               peer_points.back().second, ratio_of(seconds[1], seconds[0])});
  }
  char text[96];
  std::snprintf(text, sizeof text, "  1000 times the triangles: ours costs %.1f times as much, rtcIntersect1 %.1f times",
                ours_points.back().second / ours_points.front().second,
                peer_points.back().second / peer_points.front().second);
  table.note(text);
  table.note(fit_text("ours", fit_of(ours_points)));
  table.note(fit_text("rtcIntersect1", fit_of(peer_points)));
}

}  // namespace oclair::bench
