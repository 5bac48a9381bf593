/// Where the page gets its data: from itself, or from the server that sent it.

import { bytesOf } from './bytes';
import type { BodyData, ClearanceSample, ErrorData, PageData, PlanData, PoseData, SceneData, Touching } from './types';

/** An answer that says why something could not be done. */
export class Refusal extends Error {
  readonly touching: Touching[];

  constructor(readonly code: string, message: string, touching?: Touching[]) {
    super(message);
    this.touching = touching ?? [];
  }
}

export interface PlanRequest {
  query?: string;
  start?: number[];
  goal?: number[];
  seed: number;
  preset: string;
  strategy: string;
  deadline: number;
}

export interface PlanAnswer {
  plan: PlanData;
  clearance: ClearanceSample[] | null;
  objects: BodyData[];
}

/** A query's ends, and the objects that are elsewhere than in the scene during its motion. */
export interface QueryAnswer {
  start: number[];
  goal: number[];
  objects: BodyData[];
}

export class Server {
  /** Where the arms begin and end. */
  query(name: string): Promise<QueryAnswer> {
    return ask(`/api/query?name=${encodeURIComponent(name)}`);
  }

  ik(arm: string, q: number[], pose: PoseData): Promise<{ q: number[]; touching: Touching[] }> {
    return ask('/api/ik', { arm, q, pose });
  }

  plan(request: PlanRequest, signal: AbortSignal): Promise<PlanAnswer> {
    return ask('/api/plan', request, signal);
  }
}

async function ask<Answer>(path: string, body?: unknown, signal?: AbortSignal): Promise<Answer> {
  const request: RequestInit = { signal };
  if (body !== undefined) {
    request.method = 'POST';
    request.headers = { 'Content-Type': 'application/json' };
    request.body = JSON.stringify(body);
  }
  let response: Response;
  try {
    response = await fetch(path, request);
  } catch (error) {
    if (signal?.aborted) throw new Refusal('cancelled', 'Planning was stopped.');
    throw new Refusal('io', `The server does not answer (${(error as Error).message}). Is tandem view still running?`);
  }
  const text = await response.text();
  let answer: unknown;
  try {
    answer = JSON.parse(text);
  } catch {
    throw new Refusal('io', `The server answered ${path} with ${response.status} ${response.statusText}.`);
  }
  const error = (answer as { error?: ErrorData } | null)?.error;
  if (error) throw new Refusal(error.code, error.message, error.touching);
  if (!response.ok) throw new Refusal('io', `The server answered ${path} with ${response.status} ${response.statusText}.`);
  return answer as Answer;
}

export interface Source extends PageData {
  server: Server | null;
  mesh(index: number): Promise<ArrayBuffer>;
}

/** What the page carries, else what the server says. */
export async function openSource(): Promise<Source> {
  const text = document.getElementById('tandem-data')?.textContent ?? 'null';
  const data = JSON.parse(text) as PageData | null;
  if (data) return { ...data, server: null, mesh: (index) => embedded(data, index) };
  if (!location.protocol.startsWith('http')) {
    throw new Error('This page holds no plan. Open a plan with tandem view PLAN, or save it as a page with tandem view PLAN --export page.html.');
  }
  const [scene, plan, clearance] = await Promise.all([
    ask<SceneData>('/api/scene'),
    ask<PlanData | null>('/api/plan'),
    ask<ClearanceSample[] | null>('/api/clearance'),
  ]);
  return { scene, plan, clearance, server: new Server(), mesh: served };
}

async function served(index: number): Promise<ArrayBuffer> {
  const response = await fetch(`/mesh/${index}`);
  if (!response.ok) throw new Error(`the server answered ${response.status}`);
  return response.arrayBuffer();
}

async function embedded(data: PageData, index: number): Promise<ArrayBuffer> {
  const url = data.meshes?.[String(index)];
  if (!url) throw new Error('it is not in this page');
  return bytesOf(url).buffer;
}
