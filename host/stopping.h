// When is the picture good enough? The error of a whole image, estimated and bounded while it renders, by a method that may look
// after every block of samples. What is certified, how, and how often it was wrong: docs/decisions/stopping.md.
//
// The error of an image x of the true image mu is the root of the mean over its pixels of
//   |x_p - mu_p|^2 / (|mu_p|^2 + 0.01 |m|^2),
// |.| over the three channels, m the mean colour of the image: the relative squared error of Rousselle, Knaus, Zwicker 2011
// (Adaptive sampling and reconstruction using greedy error minimization), with a floor that makes it blind to the scale of light.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "render.h"

namespace oclair {

class ErrorMonitor {
 public:
  // Samples of a block: as many as a replica of the film has, so that blocks are independent whatever the sampler.
  static constexpr std::uint64_t usual_block = REPLICA_SAMPLES;

  // What is kept of each pixel.
  struct Pixel {
    std::array<double, 3> sum;    // of the samples up to the last film, in units of 2^film_exponent as all that follows
    std::uint64_t rejected;       // up to the last film
    std::array<float, 3> first;   // mean of the first block of a pair
    bool unknown;                 // all samples of a block were left out
    double largest;               // of all pairs, in earlier sequences too: |difference of two block means|^2 / 2
    double weight;                // 1 / (|mu|^2 + floor), from what was known before the pair
    double variance_sum;          // over the pairs of the sequence: that, without weight
  };

  // Certifies, with probability `confidence` in (0, 1), that the error is below `target` > 0. What is kept of the pixels lies in
  // `directory`, as a film would (film_vector.h); room for so many of them is taken now, for those of a larger film with it.
  ErrorMonitor(double target, double confidence, std::uint64_t block_samples = usual_block, const FilmDirectory& directory = {},
               std::size_t pixels = 0);

  // The film after another block: counts where the samples of a pixel are a multiple of the block's. A film that is further on by
  // more than a block costs what lies between, and a pair that was begun; the first film (a resumed one, too) only gives weights.
  void add(const Film& film);

  std::optional<double> estimate() const;  // of the error of the last film; nothing before the first pair of blocks
  std::optional<double> bound() const;     // the error is below this with the confidence asked for, whenever one looks
  bool certified() const;
  std::string why_not() const;  // one line for the user; empty: certified
  // Pixels of which some block has had no sample that the film took: while there are any, nothing is ever certified.
  std::uint64_t unknown_pixels() const { return unknown_pixels_; }
  std::optional<std::uint64_t> samples_expected() const;  // per pixel, until the bound reaches the target

 private:
  template <class Body>
  void for_each_pixel(const Film& film, const Body& body);
  void rebase(const Film& film);
  void begin_pair(const Film& film);
  void end_pair(const Film& film);
  void set_weights(const Film& film);
  void begin_sequence(double floor);
  std::array<double, 3> take_block(const Film& film, std::size_t pixel);
  std::array<double, 3> known_mean(const Film& film, std::size_t pixel) const;
  std::uint64_t pairs_needed() const;
  std::uint64_t samples_to_judge() const;  // per pixel, until there are so many
  bool bound_reached() const;  // after the fewest pairs: the bound is below the target
  double alpha() const;
  double burst_share() const;

  double target_, confidence_;
  std::uint64_t block_;
  std::uint64_t samples_ = 0;  // of the last film that counted
  std::optional<double> film_error_;  // image_error of that film, of all its samples, those before a resume too; nothing before bound_reached
  bool pair_begun_ = false, black_ = true;
  FilmVector<Pixel> pixels_;
  std::uint64_t unknown_pixels_ = 0;

  // The sequence of pairs that the bound rests on begins anew when the picture turns out to be much brighter than when it
  // began.
  double sequence_floor_ = 0;          // the floor of the weights when it began; 0: it has not
  std::uint64_t spent_sequences_ = 0;  // earlier ones that were long enough to certify

  // Of Y, the weighted variance of a block, mean over the pixels: one value a pair of the sequence.
  std::uint64_t pairs_ = 0;
  double mean_ = 0, square_sum_ = 0;  // running mean, sum of squared distances from it (Welford 1962)
  double largest_burst_ = 0;          // share of one Y that one cell of 8 x 8 pixels brought, times that Y
  // With the weights of today, over the pixels: mean of the weighted variance, of its square, and its maximum; largest of
  // one pair.
  double variance_mean_ = 0, variance_square_mean_ = 0, variance_most_ = 0, pixel_burst_ = 0;
};

}  // namespace oclair
