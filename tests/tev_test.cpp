// The client against a listener that decodes packets as the protocol's description has them.
#include "../host/tev.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <bit>
#include <chrono>
#include <functional>
#include <future>
#include <stdexcept>
#include <vector>

#include "../host/error.h"

namespace {

using namespace oclair;

// Listens on a free port of this machine.
class Listener {
 public:
  explicit Listener(int family = AF_INET) : socket_(::socket(family, SOCK_STREAM, 0)) {
    sockaddr_storage address{};
    socklen_t size = sizeof(sockaddr_in);
    if (family == AF_INET) {
      auto& v4 = reinterpret_cast<sockaddr_in&>(address);
      v4.sin_family = AF_INET;
      v4.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    } else {
      auto& v6 = reinterpret_cast<sockaddr_in6&>(address);
      v6.sin6_family = AF_INET6;
      v6.sin6_addr = in6addr_loopback;
      size = sizeof(sockaddr_in6);
    }
    good_ = socket_ >= 0 && bind(socket_, reinterpret_cast<sockaddr*>(&address), size) == 0 && listen(socket_, 1) == 0 &&
            getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) == 0;
    port_ = ntohs(family == AF_INET ? reinterpret_cast<sockaddr_in&>(address).sin_port
                                    : reinterpret_cast<sockaddr_in6&>(address).sin6_port);
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener() { close_now(); }

  bool good() const { return good_; }
  std::string port() const { return std::to_string(port_); }
  // -1 if nobody comes: a client that gives up fails its test, it does not hang it.
  int accepted() const {
    pollfd waiting{socket_, POLLIN, 0};
    return poll(&waiting, 1, 20000) == 1 ? accept(socket_, nullptr, nullptr) : -1;
  }
  void close_now() {
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
  }

 private:
  int socket_;
  bool good_ = false;
  unsigned port_ = 0;
};

// All that comes until the client is gone.
std::string read_all(int connection) {
  std::string all;
  std::vector<char> part(1 << 16);
  for (ssize_t n; (n = read(connection, part.data(), part.size())) > 0;) all.append(part.data(), static_cast<std::size_t>(n));
  close(connection);
  return all;
}

// Reads values one after the other; throws where a packet ends too early.
struct Reader {
  std::string bytes;
  std::size_t at = 0;

  std::uint64_t integer(int count) {
    std::uint64_t value = 0;
    for (int i = 0; i < count; ++i) value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes.at(at++))) << 8 * i;
    return value;
  }
  int int32() { return static_cast<int>(integer(4)); }
  float float32() { return std::bit_cast<float>(static_cast<std::uint32_t>(integer(4))); }
  std::string text() {
    std::string value;
    for (char c; (c = bytes.at(at++)) != '\0';) value += c;
    return value;
  }
};

// What a viewer would show: images by CreateImage (4), pixels by UpdateImage (6).
struct Viewer {
  std::string name;
  int width = 0, height = 0, created = 0, updates = 0;
  std::vector<float> pixels;  // channel by channel
  std::size_t largest = 0;

  explicit Viewer(const std::string& stream) {
    Reader all{stream};
    while (all.at < stream.size()) {
      const std::size_t begin = all.at, length = all.integer(4);
      if (length < 5 || begin + length > stream.size()) throw std::runtime_error("a packet's length is wrong");
      largest = std::max(largest, length);
      Reader packet{stream.substr(begin + 4, length - 4)};
      take(packet);
      if (packet.at != packet.bytes.size()) throw std::runtime_error("a packet is longer than what is in it");
      all.at = begin + length;
    }
  }

  void take(Reader& packet) {
    const auto operation = packet.integer(1);
    EXPECT_EQ(packet.integer(1), 0u) << "grabs the focus";
    const std::string of = packet.text();
    if (operation == 4) {
      ++created;
      name = of;
      width = packet.int32();
      height = packet.int32();
      EXPECT_EQ(packet.int32(), 3);
      for (const char* channel : {"R", "G", "B"}) EXPECT_EQ(packet.text(), channel);
      pixels.assign(std::size_t{3} * width * height, 0.0f);
    } else if (operation == 6) {
      ++updates;
      EXPECT_EQ(of, name);
      ASSERT_EQ(packet.int32(), 3);
      for (const char* channel : {"R", "G", "B"}) EXPECT_EQ(packet.text(), channel);
      const int x = packet.int32(), y = packet.int32(), w = packet.int32(), h = packet.int32();
      std::size_t offset[3], stride[3];
      for (std::size_t& o : offset) o = packet.integer(8);
      for (std::size_t& s : stride) s = packet.integer(8);
      std::vector<float> data;
      while (packet.at < packet.bytes.size()) data.push_back(packet.float32());
      for (int c = 0; c < 3; ++c)
        for (int i = 0; i < w * h; ++i)
          pixels.at((std::size_t(c) * height + y + i / w) * width + x + i % w) = data.at(offset[c] + i * stride[c]);
    } else {
      ADD_FAILURE() << "operation " << operation;
    }
  }
};

std::vector<float> ramp(unsigned width, unsigned height, float first) {
  std::vector<float> rgb(std::size_t{3} * width * height);
  for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = first + static_cast<float>(i % 100003) / 64;
  return rgb;
}

RgbOfPixels picture(std::vector<float> values) {
  return [values = std::move(values)](std::size_t first, std::span<float> rgb) { std::copy_n(values.begin() + 3 * first, rgb.size(), rgb.begin()); };
}

void expect_shown(const Viewer& viewer, unsigned width, unsigned height, const std::vector<float>& rgb) {
  ASSERT_EQ(viewer.pixels.size(), rgb.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < std::size_t{width} * height; ++i)
    for (std::size_t c = 0; c < 3; ++c) wrong += viewer.pixels[c * width * height + i] != rgb[3 * i + c];
  EXPECT_EQ(wrong, 0u);
}

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

// A bare machine may know no names at all, not even this one.
bool resolves(const char* host) {
  addrinfo* found = nullptr;
  const bool known = getaddrinfo(host, nullptr, nullptr, &found) == 0;
  if (known) freeaddrinfo(found);
  return known;
}

TEST(tev_test, a_viewer_shows_the_pixels_of_the_last_image) {
  for (const auto& [family, host] : {std::pair{AF_INET, "127.0.0.1"}, {AF_INET, "localhost"}, {AF_INET6, "::1"}}) {
    if (!resolves(host)) continue;
    const Listener listener(family);
    if (family == AF_INET6 && !listener.good()) continue;  // a machine without IPv6
    ASSERT_TRUE(listener.good());
    auto stream = std::async(std::launch::async, [&] { return read_all(listener.accepted()); });
    const auto first = ramp(7, 5, 1), second = ramp(7, 5, -3);
    {
      TevClient client({host, listener.port()});
      ASSERT_TRUE(client.connected());
      client.show("a room.exr", 7, 5, picture(first));
      client.show("a room.exr", 7, 5, picture(second));
      EXPECT_EQ(client.take_warning(), std::nullopt);
    }
    const Viewer viewer(stream.get());
    EXPECT_EQ(viewer.name, "a room.exr");
    EXPECT_EQ(viewer.width, 7);
    EXPECT_EQ(viewer.height, 5);
    EXPECT_EQ(viewer.created, 1);
    EXPECT_EQ(viewer.updates, 2);
    expect_shown(viewer, 7, 5, second);
  }
}

TEST(tev_test, large_images_go_in_packets_of_a_mebibyte_at_most) {
  for (const auto& [width, height] : {std::pair{1920u, 500u}, {65536u, 3u}, {1u, 200000u}, {1u, 1u}}) {
    const Listener listener;
    auto stream = std::async(std::launch::async, [&] { return read_all(listener.accepted()); });
    const auto rgb = ramp(width, height, 0);
    {
      TevClient client({"127.0.0.1", listener.port()});
      client.show("x", width, height, picture(rgb));
      EXPECT_TRUE(client.connected());
    }
    const Viewer viewer(stream.get());
    EXPECT_LE(viewer.largest, std::size_t{1} << 20);
    EXPECT_LE(viewer.updates, static_cast<int>(rgb.size() * 4 / (1 << 19) + 1)) << "packets are not full";
    expect_shown(viewer, width, height, rgb);
  }
}

TEST(tev_test, another_name_or_size_is_another_image) {
  const Listener listener;
  auto stream = std::async(std::launch::async, [&] { return read_all(listener.accepted()); });
  {
    TevClient client({"127.0.0.1", listener.port()});
    client.show("a", 2, 2, picture(ramp(2, 2, 0)));
    client.show("b", 2, 2, picture(ramp(2, 2, 0)));
    client.show("b", 4, 1, picture(ramp(4, 1, 0)));
  }
  const Viewer viewer(stream.get());
  EXPECT_EQ(viewer.created, 3);
  EXPECT_EQ(viewer.name, "b");
  EXPECT_EQ(viewer.width, 4);
}

TEST(tev_test, a_viewer_that_goes_away_costs_one_warning_and_no_signal) {
  const Listener listener;
  TevClient client({"127.0.0.1", listener.port()});
  ASSERT_TRUE(client.connected());
  close(listener.accepted());
  const auto rgb = ramp(1000, 1000, 0);  // more than the sockets' buffers hold
  for (int i = 0; i < 3; ++i) client.show("x", 1000, 1000, picture(rgb));  // SIGPIPE would end the test
  EXPECT_FALSE(client.connected());
  const auto warning = client.take_warning();
  ASSERT_TRUE(warning);
  EXPECT_EQ(warning->find("no live view at 127.0.0.1 port " + listener.port() + ": "), 0u) << *warning;
  client.show("x", 1000, 1000, picture(rgb));
  EXPECT_EQ(client.take_warning(), std::nullopt);
}

TEST(tev_test, a_viewer_that_never_reads_is_given_up) {
  const Listener listener;
  const auto rgb = ramp(1200, 1200, 0);  // 17 MB, 4.3 s at the slowest speed that is put up with
  TevClient client({"127.0.0.1", listener.port()}, 0.2);
  const int connection = listener.accepted();
  EXPECT_LT(seconds_of([&] { client.show("x", 1200, 1200, picture(rgb)); }), 60.0);
  EXPECT_FALSE(client.connected());
  EXPECT_EQ(client.take_warning(), "no live view at 127.0.0.1 port " + listener.port() + ": it does not read");
  close(connection);
}

TEST(tev_test, a_refused_port_is_a_warning) {
  Listener listener;
  const std::string port = listener.port();
  listener.close_now();
  TevClient client({"127.0.0.1", port});
  EXPECT_FALSE(client.connected());
  client.show("x", 1, 1, picture(ramp(1, 1, 0)));
  EXPECT_EQ(client.take_warning(), "no live view at 127.0.0.1 port " + port + ": Connection refused");
  EXPECT_EQ(client.take_warning(), std::nullopt);
}

TEST(tev_test, a_name_that_nobody_has_is_a_warning) {
  TevClient client({"name.invalid", "14158"});  // RFC 6761: never resolves
  EXPECT_FALSE(client.connected());
  EXPECT_TRUE(client.take_warning());
}

TEST(tev_test, hosts_and_ports_are_read_with_the_usual_port_as_default) {
  const auto read = [](const std::string& text) {
    const HostPort to = parse_host_port("--tev", text);
    return to.host + " " + to.port;
  };
  EXPECT_EQ(read("viewer:80"), "viewer 80");
  EXPECT_EQ(read("viewer"), "viewer 14158");
  EXPECT_EQ(read("10.0.0.1:65535"), "10.0.0.1 65535");
  EXPECT_EQ(read("[::1]:1"), "::1 1");
  EXPECT_EQ(read("[fe80::1%eth0]"), "fe80::1%eth0 14158");
}

TEST(tev_test, what_is_no_host_and_port_is_refused) {
  for (const char* text : {"", ":", ":80", "a:", "a:0", "a:65536", "a:-1", "a:+1", "a: 80", "a:80x", "a:99999999999999999999", "::1",
                           "a:1:2", "[::1", "[]:80", "[::1]80", "[::1]:"}) {
    try {
      parse_host_port("--tev", text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.exit, Exit::usage);
      EXPECT_EQ(error.what(), "--tev '" + std::string(text) + "': expected HOST:PORT, or [IPv6 ADDRESS]:PORT");
    }
  }
}
