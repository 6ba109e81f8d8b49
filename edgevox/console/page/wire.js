/**
 * The types of what passes between the robot and this page. Nothing here runs.
 * @typedef {[number, number]} Point  metres, map frame
 * @typedef {{name?: string, label?: string, points?: Point[], circle?: [number, number, number]}} Shape
 * @typedef {{name: string, label?: string, outline?: Point[], goal?: Point}} Room
 * @typedef {{name: string, label?: string, x: number, y: number}} Place
 * @typedef {{png: string, x: number, y: number, yaw: number, resolution: number}} Grid  its lower left
 *   corner, metres and radians; a pixel is a cell of so many metres, black, grey or white
 * @typedef {{version: number, bounds: [number, number, number, number], walls?: Shape[],
 *   furniture?: Shape[], rooms?: Room[], places?: Place[], grid?: Grid, radius?: number}} Scene
 * @typedef {{name: string, value: number, lower?: number, upper?: number}} Joint  radians
 * @typedef {{name: string, label?: string, x: number, y: number, z?: number, held?: boolean}} Thing
 * @typedef {{time?: number, moving?: boolean, pose?: {x: number, y: number, yaw: number},
 *   velocity?: {linear: number, angular: number}, lidar?: number[], path?: Point[],
 *   goal?: {x?: number, y?: number, progress: number, distance?: number} | null,
 *   furniture?: Shape[], battery?: {level: number, charging?: boolean} | null,
 *   joints?: Joint[], hand?: {open?: boolean | number, holding?: string | null} | null,
 *   things?: Thing[]}} Live
 * @typedef {{type?: string, title?: string, description?: string, enum?: any[], const?: any,
 *   minimum?: number, maximum?: number, exclusiveMinimum?: number, exclusiveMaximum?: number,
 *   maxLength?: number, default?: any, anyOf?: Schema[], allOf?: Schema[], $ref?: string,
 *   properties?: Record<string, Schema>, required?: string[], $defs?: Record<string, Schema>}} Schema
 * @typedef {{name: string, label?: string, language?: string, description?: string, schema: Schema, moves?: boolean,
 *   lasting?: boolean, allowed?: boolean, why?: string}} Skill
 * @typedef {{linear?: number, angular?: number}} DriveLimits  m/s, rad/s
 * @typedef {{picture?: boolean, drive?: boolean | DriveLimits, sound?: boolean, map?: boolean,
 *   goto?: boolean, name_place?: boolean,
 *   record?: boolean | string}} Capabilities  a string says what it lacks to be recorded
 * @typedef {{holder?: string | null, name?: string, mine?: boolean,
 *   waiting?: {client: string, name?: string}[]}} Lease
 * @typedef {{engaged: boolean, by?: string, since?: number}} Stop
 * @typedef {{language?: string, voice?: string, muted?: boolean, confirm?: string,
 *   languages?: string[], voices?: string[], confirms?: string[]}} Controls
 * @typedef {{name: string, level: number, message?: string, values?: Record<string, any>}} Diagnostic
 * @typedef {{turn: number, stt?: number, llm?: number, tts?: number, ttfs?: number, total?: number}}
 *   Latency  seconds
 * @typedef {{name: string, bytes?: number, begun?: number | null}} Recorded  seconds since 1970
 * @typedef {{running?: boolean, seconds?: number, bytes?: number, room?: number, full?: boolean,
 *   why?: string, files?: Recorded[]}} Recording  room: bytes that there may still be
 * @typedef {{health?: {ready?: boolean, live?: boolean, problems?: string[]},
 *   diagnostics?: Diagnostic[], latencies?: Latency[], recording?: Recording}} Status
 * @typedef {{type: string, [key: string]: any}} Message
 */
export {};
