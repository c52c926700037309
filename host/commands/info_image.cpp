#include <algorithm>
#include <iostream>

#include "../image_info.h"
#include "commands.h"
#include "report.h"

namespace oclair {
namespace {

// Attributes that it shares with the first part are not repeated.
void print_part(const PartInfo& part, const PartInfo& first) {
  row("part") << (part.name.empty() ? "" : part.name + ": ") << part.width << "x" << part.height;
  if (part.width != part.film_width || part.height != part.film_height || part.x != 0 || part.y != 0)
    std::cout << " at " << part.x << "," << part.y << " of " << part.film_width << "x" << part.film_height;
  std::cout << ", " << part.type << "\n";
  for (const ChannelInfo& channel : part.channels) {
    row("channel") << channel.name << ": " << channel.type;
    std::cout.precision(channel.type == "uint" ? 10 : 9);  // what tells every value from its neighbours
    if (channel.finite > 0) std::cout << ", from " << channel.min << " to " << channel.max << ", mean " << channel.mean;
    if (channel.infinite > 0) std::cout << ", " << channel.infinite << " infinite";
    if (channel.nan > 0) std::cout << ", " << channel.nan << " not a number";
    std::cout << "\n";
  }
  for (const auto& attribute : part.attributes) {
    const bool shared = std::find(first.attributes.begin(), first.attributes.end(), attribute) != first.attributes.end();
    if (&part == &first || !shared) row(attribute.first) << attribute.second << "\n";
  }
}

}  // namespace

Exit info_image(const std::filesystem::path& image) {
  const std::vector<PartInfo> parts = read_image_info(image);
  row("image") << image.string() << "\n";
  const auto precision = std::cout.precision();
  for (const PartInfo& part : parts) print_part(part, parts.front());
  std::cout.precision(precision);
  return Exit::success;
}

}  // namespace oclair
