// The fake's bytes on the wire against frames written down from the protocol's description.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <string>
#include <thread>

#include "tests/support/controller_fake/byte_packing.h"
#include "tests/support/controller_fake/controller_fake.h"
#include "tests/support/controller_fake/primary_packets.h"
#include "tests/support/controller_fake/rtde_variables.h"

namespace sandwright {
namespace {

using fake::ByteReader;
using fake::ByteWriter;

std::string Bytes(std::initializer_list<int> bytes) {
  std::string text;
  for (const int byte : bytes) text += static_cast<char>(byte);
  return text;
}

// A client that knows only sockets.
class Peer {
 public:
  explicit Peer(uint16_t port, int buffer = 0) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (buffer > 0) setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
    sockaddr_in where{};
    where.sin_family = AF_INET;
    where.sin_port = htons(port);
    where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{10, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&where), sizeof where), 0);
  }
  ~Peer() { close(socket_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  void Send(const std::string& bytes) { send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  // Fewer where the controller has closed.
  std::string Read(size_t size) {
    std::string bytes(size, '\0');
    const ssize_t count = recv(socket_, bytes.data(), size, MSG_WAITALL);
    bytes.resize(count < 0 ? 0 : static_cast<size_t>(count));
    return bytes;
  }
  std::string Line() {
    std::string line;
    for (std::string byte; (byte = Read(1)) != "" && byte != "\n";) line += byte;
    return line;
  }
  std::string RtdeFrame() {
    const std::string head = Read(2);
    return head + Read(ByteReader(head).U16() - 2);
  }
  // Answers and data: the next frame of a type.
  std::string RtdeFrame(char type) {
    for (;;) {
      const std::string frame = RtdeFrame();
      if (frame.size() < 3 || frame[2] == type) return frame;
    }
  }
  // Primary and secondary: the next packet whose body contains `text`.
  std::string PacketWith(const std::string& text) {
    for (int i = 0; i < 1000; ++i) {
      const std::string head = Read(4);
      if (head.size() < 4) break;
      const std::string body = Read(ByteReader(head).U32() - 4);
      if (body.find(text) != std::string::npos) return body;
    }
    return "";
  }

 private:
  int socket_;
};

std::string Frame(char type, const std::string& body) {
  return ByteWriter().U16(static_cast<uint16_t>(body.size() + 3)).U8(type).Text(body).bytes();
}
std::string Outputs(double hz, const std::string& names) {
  return Frame('O', ByteWriter().F64(hz).Text(names).bytes());
}

class Frames : public ::testing::Test {
 protected:
  ControllerFake fake_;
  Peer rtde_{fake_.ports().rtde};
};

TEST_F(Frames, RtdeNegotiation) {
  rtde_.Send(Bytes({0, 5, 'V', 0, 2}));
  EXPECT_EQ(rtde_.RtdeFrame(), Bytes({0, 4, 'V', 1}));
  rtde_.Send(Bytes({0, 3, 'v'}));
  EXPECT_EQ(rtde_.RtdeFrame(),
            Bytes({0, 0x13, 'v', 0, 0, 0, 3, 0, 0, 0, 15, 0, 0, 0, 8, 0, 1, 0x9f, 0x63}));
  rtde_.Send(Outputs(125, "timestamp,actual_q,"));
  EXPECT_EQ(rtde_.RtdeFrame(), Bytes({0, 0x13, 'O', 1}) + "DOUBLE,VECTOR6D");
  rtde_.Send(Frame('I', "speed_slider_mask,speed_slider_fraction"));
  EXPECT_EQ(rtde_.RtdeFrame(), Bytes({0, 0x11, 'I', 1}) + "UINT32,DOUBLE");
  rtde_.Send(Bytes({0, 3, 'S'}));
  EXPECT_EQ(rtde_.RtdeFrame('S'), Bytes({0, 4, 'S', 1}));
  const std::string data = rtde_.RtdeFrame('U');
  EXPECT_EQ(data.size(), 4u + 8 + 48);
  ByteReader reader(std::string_view(data).substr(3));
  EXPECT_EQ(reader.U8(), 1);
  EXPECT_GT(reader.F64(), 600);
  EXPECT_EQ(reader.F64(), -1.8476);
  rtde_.Send(Frame('U', ByteWriter().U8(1).U32(1).F64(0.3).bytes()));
  rtde_.Send(Bytes({0, 3, 'P'}));
  EXPECT_EQ(rtde_.RtdeFrame('P'), Bytes({0, 4, 'P', 1}));
  EXPECT_EQ(fake_.state().speed_slider, 0.3);
}

TEST_F(Frames, RtdeProtocol1HasNoRecipes) {
  fake_.SpeakOnlyProtocol1();
  rtde_.Send(Bytes({0, 5, 'V', 0, 2}));
  EXPECT_EQ(rtde_.RtdeFrame(), Bytes({0, 4, 'V', 0}));
  rtde_.Send(Frame('O', "timestamp"));
  EXPECT_EQ(rtde_.RtdeFrame(), Frame('O', "DOUBLE"));
  rtde_.Send(Bytes({0, 3, 'S'}));
  EXPECT_EQ(rtde_.RtdeFrame('U').size(), 3u + 8);
}

TEST_F(Frames, RtdeRefusals) {
  Peer other(fake_.ports().rtde);
  for (Peer* peer : {&rtde_, &other}) {
    peer->Send(Bytes({0, 5, 'V', 0, 2}));
    EXPECT_EQ(peer->RtdeFrame(), Bytes({0, 4, 'V', 1}));
  }
  rtde_.Send(Outputs(125, "timestamp,tool_contact"));
  EXPECT_EQ(rtde_.RtdeFrame(), Frame('O', Bytes({0}) + "DOUBLE,NOT_FOUND"));
  rtde_.Send(Bytes({0, 3, 'S'}));
  EXPECT_EQ(rtde_.RtdeFrame(), Bytes({0, 4, 'S', 0}));
  rtde_.Send(Frame('I', "input_int_register_0"));
  EXPECT_EQ(rtde_.RtdeFrame(), Frame('I', Bytes({1}) + "INT32"));
  rtde_.Send(Frame('I', "input_int_register_0,input_int_register_1"));  // again, by the same one
  EXPECT_EQ(rtde_.RtdeFrame(), Frame('I', Bytes({2}) + "INT32,INT32"));
  other.Send(Frame('I', "input_int_register_1,input_int_register_2"));
  EXPECT_EQ(other.RtdeFrame(), Frame('I', Bytes({0}) + "IN_USE,INT32"));
  Peer third(fake_.ports().rtde), fourth(fake_.ports().rtde);
  third.Send(Bytes({0, 3, 'v'}));
  EXPECT_EQ(third.RtdeFrame().size(), 19u);
  EXPECT_EQ(fourth.Read(1), "");
}

TEST_F(Frames, RtdeOfSplitAndCoalescedBytesIsTheSame) {
  fake_.SplitBytes(true);
  rtde_.Send(Bytes({0, 5, 'V'}));
  rtde_.Send(Bytes({0, 2, 0, 3, 'v'}));
  EXPECT_EQ(rtde_.RtdeFrame(), Bytes({0, 4, 'V', 1}));
  EXPECT_EQ(rtde_.RtdeFrame().size(), 19u);
  fake_.SplitBytes(false);
  fake_.CoalesceFrames(true);
  rtde_.Send(Outputs(125, "timestamp"));
  EXPECT_EQ(rtde_.RtdeFrame().size(), 10u);
  rtde_.Send(Bytes({0, 3, 'S'}));
  double last = 0;
  for (int i = 0; i < 20; ++i) {
    const std::string data = rtde_.RtdeFrame('U');
    ByteReader reader(std::string_view(data).substr(4));
    const double time = reader.F64();
    if (i > 0) {
      EXPECT_NEAR(time - last, 0.008, 1e-6);
    }
    last = time;
  }
}

TEST_F(Frames, RtdeStallsAndComesBack) {
  rtde_.Send(Bytes({0, 5, 'V', 0, 2}) + Outputs(125, "timestamp") + Bytes({0, 3, 'S'}));
  const auto time = [&] {
    const std::string data = rtde_.RtdeFrame('U');
    return ByteReader(std::string_view(data).substr(4)).F64();
  };
  double last = time(), longest = 0;
  fake_.StallRtde(0.3);
  for (int i = 0; i < 30; ++i) {
    const double now = time();
    longest = std::max(longest, now - last);
    last = now;
  }
  EXPECT_GT(longest, 0.2);
}

TEST_F(Frames, ClosedConnectionsAndClientsThatDoNotRead) {
  rtde_.Send(Bytes({0, 3, 'v'}));
  EXPECT_EQ(rtde_.RtdeFrame().size(), 19u);
  fake_.CloseConnections(false);
  EXPECT_EQ(rtde_.Read(1), "");

  ControllerFakeOptions fast;
  fast.time_factor = 20;
  ControllerFake other(fast);
  Peer lazy(other.ports().rtde, 4096);
  std::string names;
  for (const char* side : {"target", "actual"})
    for (const char* what : {"_q", "_qd", "_current", "_TCP_pose", "_TCP_speed"})
      names += std::string(side) + what + ",";
  lazy.Send(Bytes({0, 5, 'V', 0, 2}) + Outputs(125, names) + Bytes({0, 3, 'S'}));
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  uint64_t sent = 0;
  for (bool grows = true; grows && std::chrono::steady_clock::now() < end;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    const uint64_t now = other.rtde_frames_sent();
    grows = now == 0 || now > sent;
    sent = now;
  }
  EXPECT_LT(std::chrono::steady_clock::now(), end);
}

TEST(RtdeVariable, FrameOfTheDescription) {
  fake::ControllerState state;
  state.time_s = 16412.206;
  ByteWriter body;
  body.U8(1);
  for (const char* name : {"timestamp", "target_speed_fraction"})
    fake::RtdeOutputs().at(name).write(state, body);
  EXPECT_EQ(Frame('U', body.bytes()),
            Bytes({0, 0x14, 'U', 1, 0x40, 0xd0, 0x07, 0x0d, 0x2f, 0x1a, 0x9f, 0xbe, 0x3f, 0xf0,
                   0, 0, 0, 0, 0, 0}));
}

TEST_F(Frames, PrimaryTellsOfPrograms) {
  Peer primary(fake_.ports().primary);
  const std::string version = primary.PacketWith("URControl");
  ASSERT_GT(version.size(), 12u);
  EXPECT_EQ(version[0], 20);   // robot message
  EXPECT_EQ(version[10], 3);   // version
  primary.Send("def hello():\n  textmsg(\"hi\")\n  x = nothing()\nend\n");
  EXPECT_THAT(primary.PacketWith("PROGRAM_XXX_STARTED"), ::testing::EndsWith("STARTEDhello"));
  EXPECT_THAT(primary.PacketWith("hi"), ::testing::EndsWith("hi"));
  const std::string fault = primary.PacketWith("nothing");
  ASSERT_GT(fault.size(), 19u);
  EXPECT_EQ(fault[10], 10);
  ByteReader position(std::string_view(fault).substr(11));
  EXPECT_EQ(position.I32(), 3);
  EXPECT_EQ(position.I32(), 7);
  EXPECT_THAT(primary.PacketWith("PROGRAM_XXX_STOPPED"), ::testing::EndsWith("STOPPEDhello"));
}

TEST(PrimaryPacket, PartsHaveTheControllersSizes) {
  const std::string packet = fake::RobotStatePacket({}, {});
  EXPECT_EQ(ByteReader(packet).U32(), packet.size());
  EXPECT_EQ(packet[4], 16);
  std::map<int, size_t> sizes;
  for (size_t at = 5; at < packet.size();) {
    ByteReader part(std::string_view(packet).substr(at));
    const size_t size = part.U32();
    sizes[part.U8()] = size;
    at += size;
  }
  EXPECT_THAT(sizes, ::testing::ElementsAre(std::pair(0, 46u), std::pair(1, 251u),
                                            std::pair(4, 101u), std::pair(5, 225u),
                                            std::pair(6, 445u)));
  EXPECT_EQ(fake::RealtimePacket({}).size(), 1108u);
}

TEST_F(Frames, DashboardAnswersByLine) {
  Peer dashboard(fake_.ports().dashboard);
  EXPECT_EQ(dashboard.Line(), "Connected: Universal Robots Dashboard Server");
  for (const auto& [command, answer] : std::initializer_list<std::pair<const char*, const char*>>{
           {"robotmode", "Robotmode: RUNNING"},
           {"safetymode", "Safetymode: NORMAL"},
           {"get robot model", "UR10"},
           {"running", "Program running: false"},
           {"programState", "STOPPED <unnamed>"},
           {"PolyscopeVersion", "URSoftware 3.15.8.106339 (Jan 01 2020)"},
           {"play", "Failed to execute: play"},
           {"load x.urp", "File not found: x.urp"},
           {"unlock protective stop", "Failed to execute: unlock protective stop"},
           {"quit", "Disconnected"}}) {
    dashboard.Send(std::string(command) + "\n");
    EXPECT_EQ(dashboard.Line(), answer);
  }
  EXPECT_EQ(dashboard.Read(1), "");
}

}  // namespace
}  // namespace sandwright
