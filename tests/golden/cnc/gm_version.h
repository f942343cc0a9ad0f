/* generated, do not edit. */
#define GM_VERSION "0.1.0"
