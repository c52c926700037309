#include "tev.h"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "error.h"
#include "progress.h"

namespace oclair {
namespace {

enum class Operation : char { create_image = 4, update_image = 6 };

constexpr const char* default_port = "14158";
constexpr std::size_t largest_packet = 1 << 20;  // bytes: as many as the viewer has room for without growing its buffer
constexpr double slowest = 4e6;                  // bytes per second
constexpr const char* channels[] = {"R", "G", "B"};

class Packet {
 public:
  explicit Packet(Operation operation) : bytes_(4, '\0') { bytes_ += static_cast<char>(operation); }
  Packet& flag(bool value) { return bytes_ += static_cast<char>(value), *this; }
  Packet& text(const std::string& value) { return bytes_ += value, bytes_ += '\0', *this; }
  Packet& int32(std::uint32_t value) { return put(value, 4), *this; }
  Packet& int64(std::uint64_t value) { return put(value, 8), *this; }
  Packet& float32(float value) { return put(std::bit_cast<std::uint32_t>(value), 4), *this; }
  Packet& channel_names() {
    int32(std::size(channels));
    for (const char* name : channels) text(name);
    return *this;
  }
  std::string finished() {
    const std::size_t size = bytes_.size();
    for (int i = 0; i < 4; ++i) bytes_[i] = static_cast<char>(size >> 8 * i);
    return std::move(bytes_);
  }

 private:
  void put(std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i) bytes_ += static_cast<char>(value >> 8 * i);
  }
  std::string bytes_;
};

// Waits until the socket is ready or the time is up: false.
bool wait_for(int socket, short what, double deadline) {
  for (;;) {
    const double left = deadline - steady_seconds();
    if (left <= 0.0) return false;
    pollfd polled{socket, what, 0};
    const int ready = poll(&polled, 1, static_cast<int>(std::ceil(1e3 * left)));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
}

}  // namespace

HostPort parse_host_port(const std::string& option, const std::string& given) {
  const auto refuse = [&] { throw Error(Exit::usage, option + " '" + given + "': expected HOST:PORT, or [IPv6 ADDRESS]:PORT"); };
  HostPort result{given, default_port};
  std::string rest;
  if (given.starts_with('[')) {
    const std::size_t end = given.find(']');
    if (end == std::string::npos) refuse();
    result.host = given.substr(1, end - 1);
    rest = given.substr(end + 1);
  } else {
    const std::size_t colon = std::min(given.find(':'), given.size());
    result.host = given.substr(0, colon);
    rest = given.substr(colon);
  }
  if (!rest.empty()) {
    unsigned port = 0;
    const char* const end = rest.data() + rest.size();
    const auto [stop, error] = std::from_chars(rest.data() + 1, end, port);
    if (rest[0] != ':' || error != std::errc() || stop != end || port < 1 || port > 65535) refuse();
    result.port = std::to_string(port);
  }
  if (result.host.empty() || result.host.find('\0') != std::string::npos) refuse();
  return result;
}

TevClient::TevClient(const HostPort& to, double patience) : to_(to), patience_(patience) { connect(); }

TevClient::~TevClient() {
  if (socket_ >= 0) close(socket_);
}

// Tries each address that the name has.
void TevClient::connect() {
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(to_.host.c_str(), to_.port.c_str(), &wanted, &found); error != 0) {
    give_up(gai_strerror(error));
    return;
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses(found, freeaddrinfo);
  const double deadline = steady_seconds() + patience_;
  std::string why = "no address";
  for (const addrinfo* a = found; a; a = a->ai_next) {
    socket_ = socket(a->ai_family, a->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, a->ai_protocol);
    int error = socket_ < 0 || ::connect(socket_, a->ai_addr, a->ai_addrlen) < 0 ? errno : 0;
    if (error == EINPROGRESS) {
      socklen_t size = sizeof error;
      if (!wait_for(socket_, POLLOUT, deadline)) error = ETIMEDOUT;
      else if (getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size) < 0) error = errno;
    }
    if (error == 0) return;
    why = std::strerror(error);
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
  }
  give_up(why);
}

void TevClient::show(const std::string& name, unsigned width, unsigned height, const RgbOfPixels& rgb) {
  if (!connected() || width == 0 || height == 0) return;
  const double deadline = steady_seconds() + patience_ + 12.0 * width * height / slowest;
  if (name != shown_name_ || width != shown_width_ || height != shown_height_) {
    send(Packet(Operation::create_image).flag(false).text(name).int32(width).int32(height).channel_names().finished(), deadline);
    shown_name_ = name;
    shown_width_ = width;
    shown_height_ = height;
  }
  // Everything but the pixels takes 79 bytes and the name.
  const std::size_t row_bytes = std::size_t{12} * width, room = largest_packet - std::min(largest_packet, 79 + name.size());
  const unsigned rows = static_cast<unsigned>(std::clamp<std::size_t>(room / row_bytes, 1, height));
  std::vector<float> values;
  for (unsigned y = 0; y < height && connected(); y += rows) {
    const unsigned count = std::min(rows, height - y);
    Packet packet(Operation::update_image);
    packet.flag(false).text(name).channel_names().int32(0).int32(y).int32(width).int32(count);
    for (std::uint64_t channel = 0; channel < 3; ++channel) packet.int64(channel);  // offset of its first value
    for (int channel = 0; channel < 3; ++channel) packet.int64(3);                  // values from one to the next
    values.resize(std::size_t{3} * width * count);
    rgb(std::size_t{width} * y, values);
    for (const float value : values) packet.float32(value);
    send(packet.finished(), deadline);
  }
}

void TevClient::send(const std::string& packet, double deadline) {
  for (std::size_t sent = 0; connected() && sent < packet.size();) {
    const ssize_t count = ::send(socket_, packet.data() + sent, packet.size() - sent, MSG_NOSIGNAL);
    if (count >= 0) {
      sent += static_cast<std::size_t>(count);
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK)
      give_up(std::strerror(errno));
    else if (!wait_for(socket_, POLLOUT, deadline))
      give_up("it does not read");
  }
}

void TevClient::give_up(const std::string& why) {
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
  warning_ = "no live view at " + to_.host + " port " + to_.port + ": " + why;
}

std::optional<std::string> TevClient::take_warning() { return std::exchange(warning_, std::nullopt); }

}  // namespace oclair
