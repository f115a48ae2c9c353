/* A Micro XRCE-DDS client that does what its arguments say, for experiments with a real Agent.
 *
 *   scripted_client WHERE KEY ROLE [OPTION...] STEP...
 *
 * WHERE is the UDP port of an Agent or a relay on 127.0.0.1, tcp:PORT or serial:DEVICE; KEY the client key in
 * hexadecimal, ROLE is publisher, subscriber or both. The samples of topic "Numbers" are 1, 2, 3, ...
 *
 * Options:
 *   history=N          both reliable streams have N slots (8)
 *   size=N             a sample has N octets (4); what does not fit into a slot is sent in fragments
 *   besteffort         samples are written to and asked from a best-effort stream
 *   topic=NAME         another topic
 *   also=NAME          one more topic, with a data writer and a data reader of its own; up to three times
 *   mixed              samples of these further topics are asked from a best-effort stream
 *
 * Steps, done one after the other:
 *   write              give the next sample to the library; it is sent by the next step that runs the session
 *   insist MS          write; if the library refuses the sample, run the session for MS and try again, up to 500 times
 *   run MS             run the session for so long
 *   time MS            run the session until nothing has come for so long
 *   data MS            run the session until a sample comes, at most so long
 *   confirm MS         run the session until everything is confirmed, at most so long
 *   read N             ask for N samples (READ_DATA), 65535 for all that come
 *   seconds N          what is asked for from now on is to end after N seconds (max_elapsed_time); 0: no limit
 *   bytes N            what is asked for from now on is limited to N octets a second (max_bytes_per_second); 0: no limit
 *   cancel             end what was asked for (READ_DATA for 0 samples)
 *   use N              write and ask for samples of topic N from now on, of which 1 is the first
 *   sleep MS           the radio is off: nothing is sent, what arrives is gone
 *   pause MS           the program does something else; what arrives waits in the socket
 *   ping MS            ask within the session whether the Agent is there
 *   move               go on from another UDP port, as a client behind a router does when it gets another address
 *   obey               do what lines on stdin say, until its end: {"event": "run", "ms": 130, "writes": 1} writes a sample,
 *                      if the library takes it, runs the session for so long, and is answered by {"event": "returned"}
 *   abandon            end without closing the session
 *   repeat N [ STEP... ]
 *
 * Each event is printed as a line of JSON with nanoseconds since the epoch.
 *
 * It is linked with libmicroxrcedds_client and libmicrocdr and reads the counters of the output stream, which the
 * library keeps in a structure that its headers show.
 */
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>
#include <ucdr/microcdr.h>
#include <uxr/client/client.h>
#include <uxr/client/util/ping.h>

#define MTU UXR_CONFIG_UDP_TRANSPORT_MTU
#define MOST_SLOTS 64
#define MOST_REPETITIONS 500
#define MOST_TOPICS 4

static uxrSession session;
static uxrUDPTransport udp;
static uxrTCPTransport tcp;
static uxrSerialTransport serial;
static uxrStreamId output, samples_out, inputs[MOST_TOPICS];
static uxrObjectId writers[MOST_TOPICS], readers[MOST_TOPICS];
static size_t used; /* the topic that steps are about */
static uxrDeliveryControl control;
static uint32_t written;
static uint32_t sample_size = 4;
static int descriptor;
static const char* agent_port = "";
static bool silent;
static char topic_names[MOST_TOPICS][40] = {"Numbers"};
static size_t topics = 1;
static uint8_t best_effort_buffer[MTU];
static uint8_t output_buffer[MTU * MOST_SLOTS], input_buffer[MTU * MOST_SLOTS];

static void tell(const char* event, const char* name, long value) {
    const uxrOutputReliableStream* out = &session.streams.output_reliable[0];
    struct timespec now;

    if (silent) return;
    clock_gettime(CLOCK_REALTIME, &now);
    printf("{\"time\": %lld, \"event\": \"%s\"", (long long)now.tv_sec * 1000000000LL + now.tv_nsec, event);
    if (name) printf(", \"%s\": %ld", name, value);
    printf(", \"sent\": %u, \"acknowledged\": %u}\n", out->last_sent, out->last_acknown);
    fflush(stdout);
}

static void on_sample(uxrSession* of, uxrObjectId object, uint16_t request, uxrStreamId stream,
                      struct ucdrBuffer* buffer, uint16_t length, void* arguments) {
    uint32_t index = 0;

    (void)of, (void)object, (void)request, (void)stream, (void)length, (void)arguments;
    ucdr_deserialize_uint32_t(buffer, &index);
    tell("received", "index", index);
}

static bool write_sample(void) {
    ucdrBuffer buffer;

    if (uxr_prepare_output_stream(&session, samples_out, writers[used], &buffer, sample_size) == UXR_INVALID_REQUEST_ID)
        return false;
    ucdr_serialize_uint32_t(&buffer, ++written);
    for (uint32_t i = 4; i < sample_size; i++) ucdr_serialize_uint8_t(&buffer, (uint8_t)i);
    tell("written", "index", written);
    return true;
}

static void insist(int ms) {
    int refusals = 0;

    while (refusals <= MOST_REPETITIONS && !write_sample()) {
        uxr_run_session_timeout(&session, ms);
        refusals++;
    }
    if (refusals) tell("refused", "times", refusals);
}

static void wait_ms(long ms) {
    struct timespec time = {ms / 1000, ms % 1000 * 1000000};

    nanosleep(&time, NULL);
}

static void discard_what_arrived(void) {
    char octets[2048];
    long count = 0;
    int flags = fcntl(descriptor, F_GETFL);

    fcntl(descriptor, F_SETFL, flags | O_NONBLOCK);
    while (read(descriptor, octets, sizeof octets) > 0) count++;
    fcntl(descriptor, F_SETFL, flags);
    tell("awake", "discarded", count);
}

static void read_samples(long number) {
    control.max_samples = (uint16_t)number;
    uxr_buffer_request_data(&session, output, readers[used], inputs[used], &control);
    tell("asked", "samples", number);
}

/* Goes on from another UDP port; false if that cannot be. */
static bool move(void) {
    uxr_close_udp_transport(&udp);
    if (!uxr_init_udp_transport(&udp, UXR_IPv4, "127.0.0.1", agent_port)) return false;
    descriptor = udp.platform.poll_fd.fd;
    tell("moved", NULL, 0);
    return true;
}

static int fail(const char* what) {
    fprintf(stderr, "scripted_client: %s\n", what);
    return 2;
}

/* Does one step that takes a number. */
static bool step(const char* name, long number) {
    if (!strcmp(name, "run")) {
        uxr_run_session_timeout(&session, (int)number);
    } else if (!strcmp(name, "time")) {
        uxr_run_session_time(&session, (int)number);
    } else if (!strcmp(name, "data")) {
        uxr_run_session_until_data(&session, (int)number);
    } else if (!strcmp(name, "confirm")) {
        tell("confirmed", "result", uxr_run_session_until_confirm_delivery(&session, (int)number));
    } else if (!strcmp(name, "insist")) {
        insist((int)number);
    } else if (!strcmp(name, "read")) {
        read_samples(number);
    } else if (!strcmp(name, "seconds")) {
        control.max_elapsed_time = (uint16_t)number;
    } else if (!strcmp(name, "bytes")) {
        control.max_bytes_per_second = (uint16_t)number;
    } else if (!strcmp(name, "use")) {
        used = number < 1 || (size_t)number > topics ? 0 : (size_t)number - 1;
    } else if (!strcmp(name, "pause")) {
        wait_ms(number);
    } else if (!strcmp(name, "ping")) {
        tell("pinged", "answered", uxr_ping_agent_session(&session, (int)number, 1));
    } else if (!strcmp(name, "sleep")) {
        tell("asleep", "ms", number);
        wait_ms(number);
        discard_what_arrived();
    } else {
        return false;
    }
    return true;
}

/* The number behind a name in a line of JSON, or 0. */
static long number_in(const char* line, const char* name) {
    const char* found = strstr(line, name);

    return found ? strtol(found + strlen(name), NULL, 10) : 0;
}

static void obey(void) {
    char line[256];

    silent = true;
    while (fgets(line, sizeof line, stdin)) {
        if (number_in(line, "\"writes\":")) write_sample();
        uxr_run_session_timeout(&session, (int)number_in(line, "\"ms\":"));
        puts("{\"event\": \"returned\"}");
        fflush(stdout);
    }
    silent = false;
}

static int steps(int count, char** arguments);

/* Does "N [ STEP... ]" N times and gives the number of arguments that it took, or -1. */
static int repeat(int count, char** arguments) {
    int depth = 1, end = 2;

    if (count < 3 || strcmp(arguments[1], "[")) return -1;
    for (; end < count && depth; end++) depth += !strcmp(arguments[end], "[") - !strcmp(arguments[end], "]");
    if (depth) return -1;
    for (long left = atol(arguments[0]); left > 0; left--)
        if (steps(end - 3, arguments + 2)) return -1;
    return end;
}

static int steps(int count, char** arguments) {
    for (int i = 0; i < count; i++) {
        if (!strcmp(arguments[i], "write")) {
            if (!write_sample()) tell("refused", "times", 1);
        } else if (!strcmp(arguments[i], "obey")) {
            obey();
        } else if (!strcmp(arguments[i], "cancel")) {
            uxr_buffer_cancel_data(&session, output, readers[used]);
            tell("cancelled", NULL, 0);
        } else if (!strcmp(arguments[i], "move")) {
            if (!move()) return fail("no other port");
        } else if (!strcmp(arguments[i], "abandon")) {
            exit(0);
        } else if (!strcmp(arguments[i], "repeat")) {
            int taken = repeat(count - i - 1, arguments + i + 1);
            if (taken < 0) return fail("repeat N [ STEP... ]");
            i += taken;
        } else if (i + 1 < count && step(arguments[i], atol(arguments[i + 1]))) {
            i++;
        } else {
            return fail(arguments[i]);
        }
    }
    return 0;
}

static bool create_entities(bool publishes, bool subscribes) {
    uxrObjectId participant = uxr_object_id(1, UXR_PARTICIPANT_ID);
    uxrObjectId publisher = uxr_object_id(1, UXR_PUBLISHER_ID), subscriber = uxr_object_id(1, UXR_SUBSCRIBER_ID);
    char reference[sizeof topic_names + 8];
    uint16_t requests[3 + 3 * MOST_TOPICS];
    uint8_t answers[3 + 3 * MOST_TOPICS];
    size_t n = 0;

    requests[n++] = uxr_buffer_create_participant_ref(&session, output, participant, 0, "participant", UXR_REPLACE);
    for (uint16_t i = 0; i < topics; i++) {
        snprintf(reference, sizeof reference, "%s__t", topic_names[i]);
        requests[n++] = uxr_buffer_create_topic_ref(&session, output, uxr_object_id(i + 1, UXR_TOPIC_ID), participant,
                                                    reference, UXR_REPLACE);
    }
    if (publishes)
        requests[n++] = uxr_buffer_create_publisher_xml(&session, output, publisher, participant, "", UXR_REPLACE);
    for (uint16_t i = 0; publishes && i < topics; i++) {
        writers[i] = uxr_object_id(i + 1, UXR_DATAWRITER_ID);
        snprintf(reference, sizeof reference, "%s__dw", topic_names[i]);
        requests[n++] = uxr_buffer_create_datawriter_ref(&session, output, writers[i], publisher, reference, UXR_REPLACE);
    }
    if (subscribes)
        requests[n++] = uxr_buffer_create_subscriber_xml(&session, output, subscriber, participant, "", UXR_REPLACE);
    for (uint16_t i = 0; subscribes && i < topics; i++) {
        readers[i] = uxr_object_id(i + 1, UXR_DATAREADER_ID);
        snprintf(reference, sizeof reference, "%s__dr", topic_names[i]);
        requests[n++] = uxr_buffer_create_datareader_ref(&session, output, readers[i], subscriber, reference, UXR_REPLACE);
    }
    return uxr_run_session_until_all_status(&session, 10000, requests, answers, n);
}

static uxrCommunication* connect_to(const char* where) {
    struct termios attributes;

    if (!strncmp(where, "tcp:", 4)) {
        if (!uxr_init_tcp_transport(&tcp, UXR_IPv4, "127.0.0.1", where + 4)) return NULL;
        descriptor = tcp.platform.poll_fd.fd;
        return &tcp.comm;
    }
    if (!strncmp(where, "serial:", 7)) {
        descriptor = open(where + 7, O_RDWR | O_NOCTTY);
        if (descriptor < 0 || tcgetattr(descriptor, &attributes)) return NULL;
        cfmakeraw(&attributes);
        tcsetattr(descriptor, TCSANOW, &attributes);
        return uxr_init_serial_transport(&serial, descriptor, 0, 1) ? &serial.comm : NULL;
    }
    if (!uxr_init_udp_transport(&udp, UXR_IPv4, "127.0.0.1", where)) return NULL;
    agent_port = where;
    descriptor = udp.platform.poll_fd.fd;
    return &udp.comm;
}

/* Reads the options and gives the number of the first argument behind them, or -1. */
static int read_options(int count, char** arguments, uint16_t* history, bool* best_effort, bool* mixed) {
    int i = 4;

    for (; i < count; i++) {
        if (!strncmp(arguments[i], "history=", 8)) {
            *history = (uint16_t)atoi(arguments[i] + 8);
        } else if (!strncmp(arguments[i], "size=", 5)) {
            sample_size = (uint32_t)atoi(arguments[i] + 5);
        } else if (!strncmp(arguments[i], "topic=", 6)) {
            snprintf(topic_names[0], sizeof topic_names[0], "%s", arguments[i] + 6);
        } else if (!strncmp(arguments[i], "also=", 5) && topics < MOST_TOPICS) {
            snprintf(topic_names[topics++], sizeof topic_names[0], "%s", arguments[i] + 5);
        } else if (!strcmp(arguments[i], "mixed")) {
            *mixed = true;
        } else if (!strcmp(arguments[i], "besteffort")) {
            *best_effort = true;
        } else {
            break;
        }
    }
    if (!*history || *history > MOST_SLOTS || *history & (*history - 1)) return fail("history must be 1, 2, 4, ... 64"), -1;
    if (sample_size < 4) return fail("a sample has at least 4 octets"), -1;
    return i;
}

int main(int count, char** arguments) {
    uint16_t history = 8;
    bool best_effort = false, mixed = false;
    uxrStreamId input;
    uxrCommunication* communication;
    int i;

    if (count < 5) return fail("WHERE KEY publisher|subscriber|both [OPTION...] STEP...");
    if ((i = read_options(count, arguments, &history, &best_effort, &mixed)) < 0) return 2;
    communication = connect_to(arguments[1]);
    if (!communication) return fail("no transport");
    uxr_init_session(&session, communication, (uint32_t)strtoul(arguments[2], NULL, 16));
    uxr_set_topic_callback(&session, on_sample, NULL);
    if (!uxr_create_session(&session)) return fail("no answer to CREATE_CLIENT");
    output = samples_out = uxr_create_output_reliable_stream(&session, output_buffer, (size_t)MTU * history, history);
    input = uxr_create_input_reliable_stream(&session, input_buffer, (size_t)MTU * history, history);
    if (best_effort) {
        samples_out = uxr_create_output_best_effort_stream(&session, best_effort_buffer, MTU);
        input = uxr_create_input_best_effort_stream(&session);
    }
    for (size_t k = 0; k < topics; k++) inputs[k] = input;
    if (mixed && !best_effort) input = uxr_create_input_best_effort_stream(&session);
    for (size_t k = 1; k < topics; k++) inputs[k] = input;
    if (!create_entities(strcmp(arguments[3], "subscriber"), strcmp(arguments[3], "publisher")))
        return fail("the Agent refuses the entities");
    for (int k = i; k < count; k++) /* takes the last answers to its set-up before it is ready to obey */
        if (!strcmp(arguments[k], "obey")) uxr_run_session_timeout(&session, 200);
    tell("ready", NULL, 0);
    if (steps(count - i, arguments + i)) return 2;
    tell("done", NULL, 0);
    uxr_delete_session_retries(&session, 1);
    return 0;
}
