/* The rival of `cargo bench --bench visibility -- --rival PROGRAM`: the same rays through Embree 4, robust, one ray at a
 * time.
 *
 *   embree DIRECTORY QUALITY [THREADS]        QUALITY: 1 = medium (Embree's default), 2 = high (spatial splits)
 *
 * DIRECTORY holds `triangles` (9 f32 each), and `closest` and `any` (rays: origin, t_min, direction, t_max, 8 f32 each).
 * Answers every line on stdin with a line: `build` (milliseconds), `closest` or `any` (nanoseconds of one pass over the
 * rays). The last answers are left in `closest.embree` and `any.embree`, 4 bytes a ray: the triangle or -1; 1 or 0.
 *
 * Build: cc -O2 -pthread embree.c -o embree LIBRARY, where LIBRARY is any libembree4 shared library. Embree's public interface is
 * declared here as far as it is used, so its headers are not needed.
 */
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct { _Alignas(16) float org[3]; float tnear, dir[3], time, tfar; uint32_t mask, id, flags; } Ray;
typedef struct { _Alignas(16) float normal[3]; float u, v; uint32_t prim, geom, inst, inst_prim; } HitInfo;
typedef struct { Ray ray; HitInfo hit; } RayHit;

extern void *rtcNewDevice(const char *config);
extern int rtcGetDeviceError(void *device);
extern void *rtcNewScene(void *device);
extern void rtcSetSceneFlags(void *scene, int flags);
extern void rtcSetSceneBuildQuality(void *scene, int quality);
extern void *rtcNewGeometry(void *device, int type);
extern void *rtcSetNewGeometryBuffer(void *geometry, int type, unsigned slot, int format, size_t stride, size_t count);
extern void rtcCommitGeometry(void *geometry);
extern unsigned rtcAttachGeometry(void *scene, void *geometry);
extern void rtcCommitScene(void *scene);
extern void rtcReleaseScene(void *scene);
extern void rtcIntersect1(void *scene, RayHit *ray_hit, void *arguments);
extern void rtcOccluded1(void *scene, Ray *ray, void *arguments);

enum { TRIANGLES = 0, INDEX = 0, VERTEX = 1, UINT3 = 0x5003, FLOAT3 = 0x9003, ROBUST = 1 << 2 };

static double now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static char *path_in(const char *directory, const char *name) {
    static char path[4096];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    return path;
}

static float *read_floats(const char *directory, const char *name, size_t *count) {
    FILE *file = fopen(path_in(directory, name), "rb");
    if (!file) { perror(name); exit(1); }
    fseek(file, 0, SEEK_END);
    *count = (size_t)ftell(file) / sizeof(float);
    rewind(file);
    float *data = malloc(*count * sizeof(float) + 1);
    if (fread(data, sizeof(float), *count, file) != *count) { perror(name); exit(1); }
    fclose(file);
    return data;
}

static void write_answers(const char *directory, const char *name, const int32_t *answers, size_t count) {
    FILE *file = fopen(path_in(directory, name), "wb");
    if (!file || fwrite(answers, sizeof *answers, count, file) != count) { perror(name); exit(1); }
    fclose(file);
}

static void *build(void *device, const float *vertices, size_t floats, int quality) {
    void *scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, ROBUST);
    rtcSetSceneBuildQuality(scene, quality);
    void *mesh = rtcNewGeometry(device, TRIANGLES);
    memcpy(rtcSetNewGeometryBuffer(mesh, VERTEX, 0, FLOAT3, 12, floats / 3), vertices, floats * sizeof(float));
    uint32_t *index = rtcSetNewGeometryBuffer(mesh, INDEX, 0, UINT3, 12, floats / 9);
    for (size_t i = 0; i < floats / 3; i++) index[i] = (uint32_t)i;
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    rtcCommitScene(scene);
    return scene;
}

static Ray ray_from(const float *r) {
    Ray ray = {{r[0], r[1], r[2]}, r[3], {r[4], r[5], r[6]}, 0.0f, r[7], ~0u, 0, 0};
    return ray;
}

/* A pass over rays: threads take CHUNK of them at a time. */
enum { CHUNK = 4096 };
typedef struct { void *scene; const float *rays; int32_t *answers; size_t count; int any; atomic_size_t next; } Pass;

static void *trace(void *argument) {
    Pass *pass = argument;
    for (size_t begin; (begin = atomic_fetch_add(&pass->next, CHUNK)) < pass->count;) {
        size_t end = begin + CHUNK < pass->count ? begin + CHUNK : pass->count;
        if (pass->any) {
            for (size_t i = begin; i < end; i++) {
                Ray ray = ray_from(pass->rays + 8 * i);
                rtcOccluded1(pass->scene, &ray, NULL);
                pass->answers[i] = ray.tfar == -INFINITY;
            }
        } else {
            for (size_t i = begin; i < end; i++) {
                RayHit q = {ray_from(pass->rays + 8 * i), {{0}, 0, 0, ~0u, ~0u, ~0u, ~0u}};
                rtcIntersect1(pass->scene, &q, NULL);
                pass->answers[i] = q.hit.geom == ~0u ? -1 : (int32_t)q.hit.prim;
            }
        }
    }
    return NULL;
}

static void trace_all(Pass *pass, int threads) {
    pthread_t others[64];
    for (int k = 1; k < threads; k++) pthread_create(&others[k], NULL, trace, pass);
    trace(pass);
    for (int k = 1; k < threads; k++) pthread_join(others[k], NULL);
}

int main(int argc, char **argv) {
    int threads = argc > 3 ? atoi(argv[3]) : 1;
    if (argc < 3 || argc > 4 || threads < 1 || threads > 64) {
        fprintf(stderr, "usage: embree DIRECTORY QUALITY [THREADS]\n");
        return 2;
    }
    int quality = atoi(argv[2]);
    size_t floats, closest_floats, any_floats;
    float *vertices = read_floats(argv[1], "triangles", &floats);
    float *closest = read_floats(argv[1], "closest", &closest_floats);
    float *any = read_floats(argv[1], "any", &any_floats);
    size_t closest_count = closest_floats / 8, any_count = any_floats / 8;
    int32_t *closest_answers = malloc(4 * closest_count + 4), *any_answers = malloc(4 * any_count + 4);
    void *device = rtcNewDevice(NULL);
    void *scene = build(device, vertices, floats, quality);
    if (rtcGetDeviceError(device)) { fprintf(stderr, "embree refuses\n"); return 1; }
    char line[64];
    while (fgets(line, sizeof line, stdin)) {
        double start = now_ns();
        if (!strncmp(line, "build", 5)) {
            rtcReleaseScene(scene);
            start = now_ns();
            scene = build(device, vertices, floats, quality);
            printf("%.3f\n", (now_ns() - start) * 1e-6);
        } else if (!strncmp(line, "closest", 7)) {
            Pass pass = {scene, closest, closest_answers, closest_count, 0, 0};
            trace_all(&pass, threads);
            printf("%.0f\n", now_ns() - start);
            write_answers(argv[1], "closest.embree", closest_answers, closest_count);
        } else if (!strncmp(line, "any", 3)) {
            Pass pass = {scene, any, any_answers, any_count, 1, 0};
            trace_all(&pass, threads);
            printf("%.0f\n", now_ns() - start);
            write_answers(argv[1], "any.embree", any_answers, any_count);
        }
        fflush(stdout);
    }
    return 0;
}
