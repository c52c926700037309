// The picture on the way in the viewer tev (https://github.com/Tom94/tev), over its TCP protocol: packets of a 32-bit length, which
// counts itself, a byte that says what they are, and what belongs to it, all little-endian. A viewer that is not there, goes away
// or does not read costs a bounded time and one warning; the render goes on.
#pragma once

#include <optional>
#include <string>

#include "image.h"

namespace oclair {

struct HostPort {
  std::string host, port;
};

// "HOST", "HOST:PORT", "[IPv6]:PORT"; the port that tev listens on unless told otherwise: 14158. Throws Error(Exit::usage).
HostPort parse_host_port(const std::string& option, const std::string& given);

class TevClient {
 public:
  // Connects. `patience`: seconds to connect, and to send an image over those that its bytes take at 4 MB/s.
  explicit TevClient(const HostPort& to, double patience = 2.0);
  TevClient(const TevClient&) = delete;
  TevClient& operator=(const TevClient&) = delete;
  ~TevClient();

  // Shows an image under this name in place of the one before: rows from the top. The first one of a name or size makes it appear.
  // Does nothing without a connection.
  void show(const std::string& name, unsigned width, unsigned height, const RgbOfPixels& rgb);

  bool connected() const { return socket_ >= 0; }
  std::optional<std::string> take_warning();  // what went wrong, once

 private:
  void connect();
  void send(const std::string& packet, double deadline);
  void give_up(const std::string& why);

  HostPort to_;
  double patience_;
  int socket_ = -1;
  std::optional<std::string> warning_;
  std::string shown_name_;
  unsigned shown_width_ = 0, shown_height_ = 0;
};

}  // namespace oclair
